// The live camera of an invited person: it records a gesture hands-free, after a countdown.

import { mirror } from "../camera/mirror.js";
import { countDown, record } from "../camera/recording.js";
import { drawTrouble } from "../camera/trouble.js";
import { cameraLost, release, showCamera, whyNoCamera } from "../camera/video-source.js";
import { h } from "../core/dom.js";

const INSTEAD = "record with the phone\u2019s own camera, or choose a clip";
const SECONDS_BEFORE = 5; // to step back from the phone
const TONES = { tick: 660, begin: 990, end: 440 }; // Hz
const TONE_SECONDS = 0.15;

/** @type {AudioContext | null} */
let audio = null;

/**
 * A short tone, because whoever stands away from the phone hears better than reads.
 *
 * @param {keyof typeof TONES} kind
 */
function sound(kind) {
  if (!audio) return;
  const tone = audio.createOscillator();
  tone.frequency.value = TONES[kind];
  tone.connect(audio.destination);
  tone.start();
  tone.stop(audio.currentTime + TONE_SECONDS);
}

/**
 * Make the camera; `ended()` is called when it is lost, `again()` to try once more.
 *
 * @param {{ ended: () => void, again: () => void }} options
 */
export function takeCamera({ ended, again }) {
  const video = h("video", {
    muted: true,
    playsInline: true,
    "aria-label": "What the camera sees",
  });
  const count = h("p", { className: "count", "aria-hidden": "true", hidden: true });
  const left = h("progress", { "aria-label": "Recording", max: 1, value: 0, hidden: true });
  const trouble = h("div", { className: "camera-problem", role: "alert", hidden: true });
  const element = h(
    "div",
    { className: "picture mirrored", hidden: true },
    video,
    count,
    left,
    trouble,
  );

  function stop() {
    release(video);
    element.hidden = trouble.hidden;
  }

  /** Start the camera; whether there is one now. */
  async function start() {
    audio ??= new AudioContext(); // Phones allow it only while a button is pressed.
    element.hidden = false;
    drawTrouble(trouble, null, again);
    try {
      await showCamera(video, "", () => {
        drawTrouble(trouble, cameraLost(INSTEAD), again);
        stop();
        ended();
      });
    } catch (error) {
      drawTrouble(trouble, whyNoCamera(error, INSTEAD), again);
      release(video);
      return false;
    }
    mirror(element, video);
    return true;
  }

  /**
   * Count down and record for so many seconds; null where nothing was recorded. `signal` ends the
   * countdown or the recording early, and drops it if its reason is "drop".
   *
   * @param {number} seconds
   * @param {AbortSignal} signal
   * @param {(step: "ready" | "recording") => void} step
   */
  async function take(seconds, signal, step) {
    step("ready");
    const show = (/** @type {number | null} */ number) => {
      count.hidden = number === null;
      count.textContent = number === null ? "" : String(number);
      if (number !== null && number <= 3) sound("tick");
    };
    if (!(await countDown(SECONDS_BEFORE, show, signal))) return null;
    const { srcObject } = video;
    if (!(srcObject instanceof MediaStream)) return null;
    sound("begin");
    step("recording");
    const recording = record(srcObject);
    element.classList.add("recording");
    left.hidden = false;
    const since = performance.now();
    await new Promise((resolve) => {
      const timer = setInterval(() => {
        left.value = Math.min(1, (performance.now() - since) / (1000 * seconds));
        if (left.value < 1 && !signal.aborted) return;
        clearInterval(timer);
        resolve(null);
      }, 100);
    });
    element.classList.remove("recording");
    left.hidden = true;
    sound("end");
    const file = await recording.stop("take");
    return signal.reason === "drop" ? null : file;
  }

  return { element, start, stop, take };
}
