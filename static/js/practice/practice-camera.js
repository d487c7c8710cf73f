// The camera of practice: it records all the time, and each completed take becomes a clip.

import { makeCamera } from "../camera/camera.js";
import { howTo, situation } from "../camera/take-steps.js";
import { SALUTE } from "../clips/salute-threshold.js";
import { saluteHand } from "../clips/salutes.js";
import { state } from "../core/state.js";
import { buttonOf, html } from "../templates.js";

/** @import { Seen } from "../camera/live-messages.d.ts" */
/** @import { Recording } from "../camera/recording.js" */

const LEAD = 2000; // ms before a take that its clip shows at least; what is seen is told later.
const LONGEST = 5 * 60_000; // ms of one recording.

/**
 * Make the camera. `started()` is called when it starts; `nameOf()` returns the name of a take's
 * clip, and `taken(file)` receives the clip.
 *
 * @param {{ draw: () => void, started: () => void, nameOf: () => string, taken: (file: File) => void }} options
 */
export function practiceCamera({ draw, started, nameOf, taken }) {
  const camera = makeCamera({ instead: "show the gesture by a clip", draw, start, stop });
  const hand = saluteHand();
  /** @type {Recording | null} */
  let recording = null;
  /** @type {Recording | null} the one after it, which begins while nothing is shown */
  let later = null;
  let since = 0; // when the newer of both began, by the page's clock
  let words = "";

  const kind = () => state.gestures?.trigger?.kind ?? "salute";
  /** Whether takes begin by a salute or a pose, before which nothing needs to be kept. */
  const bounded = () => kind() === "salute" || kind() === "pose";

  function begin() {
    since = performance.now();
    return camera.record();
  }

  /** End the running recordings, and drop them. */
  function drop() {
    recording?.stop();
    later?.stop();
    recording = later = null;
  }

  function renew() {
    drop();
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
    camera.reset();
    const whole = recording;
    if (!whole) return;
    recording = null;
    renew();
    const file = await whole.stop(nameOf());
    if (file) taken(file);
  }

  /** @param {Seen} answer */
  function seen(answer) {
    say(situation(answer, kind())[1]);
    if (answer.state === "idle" && bounded() && answer.salute <= SALUTE) return shorten();
    later?.stop(); // What is shown now is in the other one.
    later = null;
    return performance.now() - since > LONGEST ? renew() : undefined;
  }

  /** @param {string} text */
  function say(text) {
    words = text;
    draw();
  }

  /**
   * Say that the connection has failed: the camera goes on, but the end of a take is no longer
   * detected.
   *
   * @param {string} reason
   */
  function ended(reason) {
    camera.unwatch();
    camera.put({ drawing: null });
    say(`${reason} Show the gesture, then press \u201cRecognise now\u201d.`);
  }

  function stop() {
    drop();
    camera.off();
  }

  async function start() {
    stop();
    if (!(await camera.show())) return;
    // The user may take long to allow the camera.
    if (state.view !== "practice") {
      stop();
      return;
    }
    started();
    renew();
    words = "";
    camera.overlay();
    camera.put({ recording: true });
    camera.video.scrollIntoView({ block: "nearest" });
    const opened = camera.watch({ kind, seen, ended, taken: finish });
    camera.listen(state.language);
    await opened.opened;
    if (opened.goesOn()) opened.begin();
  }

  return {
    stop,
    /** Recognise with the language on display from now on. */
    listen: () => camera.listen(state.language),
    /**
     * The camera and what it asks for.
     *
     * @param {{ hidden: boolean, possible: boolean }} more `possible`: whether it may be started
     */
    panel({ hidden, possible }) {
      const { on, busy } = camera.shown;
      return html`<div class="practice-camera" ?hidden=${hidden}>
        ${camera.picture({ idle: html`${hand}The camera is off` })}
        <p class="practice-step" role="status">${(on && words) || howTo(kind())}</p>
        <div class="practice-actions">
          ${buttonOf(on ? "Stop the camera" : "Start the camera", on ? stop : start, {
            look: on ? "" : "primary",
            writes: true,
            disabled: busy || !(on || possible),
          })}${buttonOf("Recognise now", finish, {
            title: "Ends the take, where its end was not seen",
            hidden: !on,
            disabled: !possible,
          })}${camera.choice()}
        </div>
      </div>`;
    },
  };
}
