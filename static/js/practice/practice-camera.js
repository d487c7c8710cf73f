// The camera of practice: it records all the time, and each completed take becomes a clip.

import { startCamera } from "../camera/camera.js";
import { drawSeen, overlay } from "../camera/pose-overlay.js";
import { record } from "../camera/recording.js";
import { takeEnd } from "../camera/take-end.js";
import { howTo, situation } from "../camera/take-steps.js";
import { cameraPossible, offerCameras, release } from "../camera/video-source.js";
import { watch } from "../camera/watching.js";
import { SALUTE } from "../clips/salute-threshold.js";
import { saluteHand } from "../clips/salutes.js";
import { h, WRITES } from "../core/dom.js";
import { state } from "../core/state.js";

/** @import { Recognized, Seen } from "../camera/live-messages.d.ts" */

const INSTEAD = "show the gesture by a clip";
const LEAD = 2000; // ms before a take that its clip shows at least; what is seen is told later.
const LONGEST = 5 * 60_000; // ms of one recording.

/**
 * Make the camera. `started()` is called when it starts; `nameOf()` returns the name of a take's
 * clip, and `taken(file)` receives the clip.
 *
 * @param {{ started: () => void, nameOf: () => string, taken: (file: File) => void }} options
 */
export function practiceCamera({ started, nameOf, taken }) {
  const video = h("video", {
    muted: true,
    playsInline: true,
    "aria-label": "What the camera sees",
  });
  const idle = h("div", { className: "camera-idle" }, saluteHand(), "The camera is off");
  const trouble = h("div", { className: "camera-problem", role: "alert", hidden: true });
  const picture = h("div", { className: "camera-picture mirrored" }, video, idle, trouble);
  const words = h("p", { className: "practice-step", role: "status" });
  const toggle = h("button", { type: "button", ...WRITES });
  const judge = h(
    "button",
    { type: "button", title: "Ends the take, where its end was not seen", hidden: true },
    "Recognise now",
  );
  const choice = h("select", { "aria-label": "Camera", hidden: true });
  const element = h(
    "div",
    { className: "practice-camera" },
    picture,
    words,
    h("div", { className: "practice-actions" }, toggle, judge, choice),
  );

  /** @type {ReturnType<typeof record> | null} */
  let recording = null;
  /** @type {ReturnType<typeof record> | null} the one after it, which begins while nothing is shown */
  let later = null;
  let since = 0; // when the newer of both began, by the page's clock
  /** @type {ReturnType<typeof watch> | null} */
  let watching = null;
  /** @type {SVGSVGElement | null} */
  let drawing = null;
  const end = takeEnd(() => finish());

  function draw() {
    const running = recording !== null;
    toggle.replaceChildren(running ? "Stop the camera" : "Start the camera");
    toggle.className = running ? "" : "primary";
    idle.hidden = running;
    judge.hidden = !running;
    picture.classList.toggle("recording", running);
    if (!running) words.textContent = howTo(kind());
  }

  function begin() {
    const { srcObject } = video;
    since = performance.now();
    return srcObject instanceof MediaStream ? record(srcObject) : null;
  }

  /** Begin a new recording and drop the running ones. */
  function renew() {
    recording?.stop();
    later?.stop();
    later = null;
    recording = begin();
  }

  /** Drop what was recorded while nothing was shown, but for the last moments. */
  function shorten() {
    if (performance.now() - since < LEAD) return;
    if (later) {
      recording?.stop();
      recording = later;
    }
    later = begin();
  }

  /** Pass on the recorded file, and begin a new recording. */
  async function finish() {
    end.reset();
    const whole = recording;
    if (!whole) return;
    recording = null;
    renew();
    const file = await whole.stop(nameOf());
    if (file) taken(file);
  }

  /** @param {Seen} answer */
  function seen(answer) {
    if (drawing) drawSeen(drawing, answer);
    const [, text] = situation(answer, kind());
    if (words.textContent !== text) words.textContent = text;
    end.seen(answer);
    if (answer.state === "idle" && bounded() && answer.salute <= SALUTE) return shorten();
    later?.stop(); // What is shown now is in the other one.
    later = null;
    return performance.now() - since > LONGEST ? renew() : undefined;
  }

  const kind = () => state.gestures?.trigger?.kind ?? "salute";
  /** Whether takes begin by a salute or a pose, before which nothing needs to be kept. */
  const bounded = () => kind() === "salute" || kind() === "pose";

  /** @param {Recognized} result */
  const recognized = (result) => end.recognized(result, kind());

  /**
   * Show that the connection has failed: the camera goes on, but the end of a take is no longer
   * detected.
   *
   * @param {string} reason
   */
  function unwatched(reason) {
    watching?.stop();
    watching = null;
    drawing?.remove();
    words.textContent = `${reason} Show the gesture, then press \u201cRecognise now\u201d.`;
  }

  function stop() {
    end.reset();
    watching?.stop();
    recording?.stop();
    later?.stop();
    release(video);
    drawing?.remove();
    watching = recording = later = drawing = null;
    draw();
  }

  async function start() {
    stop();
    toggle.disabled = true;
    const options = { instead: INSTEAD, again: start, lost: stop, device: choice.value };
    const isOn = await startCamera({ video, picture, box: trouble }, options);
    toggle.disabled = false;
    if (cameraPossible()) offerCameras(choice, video);
    if (!isOn) return;
    // The user may take long to allow the camera.
    if (state.view !== "practice") {
      stop();
      return;
    }
    started();
    drawing = overlay(video);
    renew();
    draw();
    picture.scrollIntoView({ block: "nearest" });
    const opened = watch(video, { seen, recognized, listening: () => {}, ended: unwatched });
    watching = opened;
    opened.listen(state.language);
    await opened.opened;
    if (watching === opened) opened.begin();
  }

  toggle.onclick = () => (recording ? stop() : start());
  judge.onclick = finish;
  choice.onchange = start;
  addEventListener("pagehide", stop);
  draw();
  return {
    element,
    stop,
    draw,
    /** Recognise with this language from now on. */
    listen: () => watching?.listen(state.language),
    /**
     * Set whether the camera may be started.
     *
     * @param {boolean} possible
     */
    allow: (possible) => {
      toggle.disabled = !possible && !recording;
      judge.disabled = !possible;
    },
  };
}
