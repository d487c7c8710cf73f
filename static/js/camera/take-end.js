// The end of a take before the camera, from what the server sees: when its closing trigger is over.

/** @import { Recognized, Seen } from "./live-messages.d.ts" */

const AFTER_TAKE = 1000; // ms, so that the clip shows the whole end of a gesture.

/**
 * Watch for the ends of takes; `over()` is called at each.
 *
 * @param {() => unknown} over
 */
export function takeEnd(over) {
  let ended = false; // a take ended, and its closing trigger is still held
  let ending = 0; // timer of a take's end
  return {
    /** @param {Pick<Seen, "state">} answer */
    seen({ state }) {
      // Wait until the closing salute is over: on the next clip it would begin a take.
      if (ended && state !== "done") over();
      ended = state === "done";
    },
    /**
     * @param {Pick<Recognized, "closed">} result
     * @param {string} trigger
     */
    recognized({ closed }, trigger) {
      if (!closed) return;
      // The look at which a held trigger ended the take may be left out on a slow machine.
      if (trigger !== "gesture" && trigger !== "none") ended = true;
      else ending ||= setTimeout(over, AFTER_TAKE);
    },
    reset() {
      clearTimeout(ending);
      ending = 0;
      ended = false;
    },
  };
}
