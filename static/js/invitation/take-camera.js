// The live camera of an invited person: it records a gesture hands-free, after a countdown.

import { makeCamera } from "../camera/camera.js";
import { token } from "./take-sending.js";

/** @import { Seen } from "../camera/live-messages.d.ts" */

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
 * Make the camera; `ended()` is called when it is lost, `again()` to try once more.
 *
 * @param {{ draw: () => void, ended: () => void, again: () => void }} options
 */
export function takeCamera({ draw, ended, again }) {
  const instead = "record with the phone\u2019s own camera, or choose a clip";
  const camera = makeCamera({ instead, draw, start: again, stop: ended });

  /** Start the camera; whether there is one now. */
  function start() {
    audio ??= new AudioContext(); // Phones allow it only while a button is pressed.
    return camera.show();
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
    const look = { begun: false, over: false, watching: true };
    const opened = camera.watch(
      {
        kind: () => trigger,
        taken: () => Object.assign(look, { over: true }),
        seen: (answer) => look.begun && step("recording", answer),
        ended: () => Object.assign(look, { watching: false }), // It may have no place to look.
      },
      { path: "/invited/live", protocols: ["osg-studio.take", token()] },
    );
    // The server's first look takes longest: it is over when the recording begins. No more pictures
    // before: a salute in the countdown is no part of the recording.
    void opened.opened.then(() => opened.look(camera.video.currentTime));
    const ready = await camera.countDown(SECONDS_BEFORE, signal, (left) => {
      if (left !== null && left <= 3) sound("tick");
    });
    const recording = ready ? camera.record() : null;
    if (!recording) {
      opened.stop();
      return null;
    }
    look.begun = true;
    opened.begin();
    sound("begin");
    step("recording");
    camera.put({ recording: true, share: 0 });
    const since = performance.now();
    await new Promise((resolve) => {
      const timer = setInterval(() => {
        const most = seconds + (look.watching ? MORE_SECONDS : 0);
        const share = Math.min(1, (performance.now() - since) / (1000 * most));
        camera.put({ share });
        if (share < 1 && !look.over && !signal.aborted) return;
        clearInterval(timer);
        resolve(null);
      }, 100);
    });
    opened.stop();
    camera.put({ recording: false, share: null });
    sound("end");
    const file = await recording.stop("take");
    return signal.reason === "drop" ? null : file;
  }

  return { ...camera, start, take };
}
