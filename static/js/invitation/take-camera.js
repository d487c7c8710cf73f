// The live camera of an invited person: it records a gesture hands-free, after a countdown.

import { startCamera } from "../camera/camera.js";
import { countDown, record } from "../camera/recording.js";
import { takeEnd } from "../camera/take-end.js";
import { release } from "../camera/video-source.js";
import { watch } from "../camera/watching.js";
import { elementOf, html } from "../templates.js";
import { token } from "./take-sending.js";

/** @import { Recognized, Seen } from "../camera/live-messages.d.ts" */

const INSTEAD = "record with the phone\u2019s own camera, or choose a clip";
const SECONDS_BEFORE = 5; // to step back from the phone
const MORE_SECONDS = 20; // of a recording whose end the server sees, for who begins late
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
 * Let the server look for the end of a take before the camera; it may have no place to look.
 * `seen()` gets what it sees of the recording.
 *
 * @param {HTMLVideoElement} video
 * @param {string} trigger
 * @param {(answer: Seen) => void} seen
 */
function watchTake(video, trigger, seen) {
  const look = { over: false, watching: true, begin: () => {}, stop: () => {} };
  const end = takeEnd(() => {
    look.over = true;
  });
  let begun = false;
  const watching = watch(
    video,
    {
      seen: (answer) => {
        end.seen(answer);
        if (begun) seen(answer);
      },
      recognized: (/** @type {Recognized} */ result) => end.recognized(result, trigger),
      listening: () => {},
      ended: () => {
        look.watching = false;
      },
    },
    { path: "/invited/live", protocols: ["osg-studio.take", token()] },
  );
  // The server's first look takes longest: it is over when the recording begins. No more pictures
  // before: a salute in the countdown is no part of the recording.
  void watching.opened.then(() => watching.look(video.currentTime));
  look.begin = () => {
    begun = true;
    watching.begin();
  };
  look.stop = () => {
    watching.stop();
    end.reset();
  };
  return look;
}

/**
 * Make the camera; `ended()` is called when it is lost, `again()` to try once more.
 *
 * @param {{ ended: () => void, again: () => void }} options
 */
export function takeCamera({ ended, again }) {
  const element = elementOf(
    html`<div class="picture mirrored" hidden>
      <video .muted=${true} playsinline aria-label="What the camera sees"></video>
      <p class="count" aria-hidden="true" hidden></p>
      <progress aria-label="Recording" max="1" value="0" hidden></progress>
      <div class="camera-problem" role="alert" hidden></div>
    </div>`,
  );
  const [video, count, left, trouble] = /** @type {any} */ (element.children);

  function stop() {
    release(video);
    element.hidden = trouble.hidden;
  }

  /** Start the camera; whether there is one now. */
  async function start() {
    audio ??= new AudioContext(); // Phones allow it only while a button is pressed.
    element.hidden = false;
    const lost = () => {
      stop();
      ended();
    };
    const place = { video, picture: element, box: trouble };
    return startCamera(place, { instead: INSTEAD, again, lost });
  }

  /**
   * Count down and record until the take ends, or for so many seconds where the server does not
   * look; null where nothing was recorded. `signal` ends the countdown or the recording early, and
   * drops it if its reason is "drop".
   *
   * @param {{ seconds: number, trigger: string, signal: AbortSignal }} wanted
   * @param {(step: "ready" | "recording", seen?: Seen) => void} step told again of what is seen
   */
  async function take({ seconds, trigger, signal }, step) {
    step("ready");
    const show = (/** @type {number | null} */ number) => {
      count.hidden = number === null;
      count.textContent = number === null ? "" : String(number);
      if (number !== null && number <= 3) sound("tick");
    };
    const look = watchTake(video, trigger, (seen) => step("recording", seen)); // The server takes its time to begin.
    const ready = await countDown(SECONDS_BEFORE, show, signal);
    const { srcObject } = video;
    if (!ready || !(srcObject instanceof MediaStream)) {
      look.stop();
      return null;
    }
    look.begin();
    sound("begin");
    step("recording");
    const recording = record(srcObject);
    element.classList.add("recording");
    left.hidden = false;
    const since = performance.now();
    await new Promise((resolve) => {
      const timer = setInterval(() => {
        const most = seconds + (look.watching ? MORE_SECONDS : 0);
        left.value = Math.min(1, (performance.now() - since) / (1000 * most));
        if (left.value < 1 && !look.over && !signal.aborted) return;
        clearInterval(timer);
        resolve(null);
      }, 100);
    });
    look.stop();
    element.classList.remove("recording");
    left.hidden = true;
    sound("end");
    const file = await recording.stop("take");
    return signal.reason === "drop" ? null : file;
  }

  return { element, start, stop, take };
}
