// The takes of the library's clips, of which gestures are made: loaded a few clips at a time.

import { takesLanguage } from "../clips/salutes.js";
import * as api from "../core/api.js";
import { state } from "../core/state.js";
import { attempt } from "../core/toasts.js";
import { triggerKey } from "../languages/language-trigger.js";

/** @import { Take } from "../core/types.d.ts" */

const AT_ONCE = 4; // A library has hundreds of clips, and what else is asked for must not wait.

/** @type {Map<string, Take[]>} */
export const takes = new Map(); // by clip; they change with the language's trigger alone
/** @type {Set<string>} */
const asked = new Set();
/** @type {Set<string>} */
const failed = new Set();
let foundBy = ""; // the trigger by which they were found
let loading = 0;

/** Ask again, at the next time, for the takes that could not be loaded. */
export function forgetFailures() {
  for (const id of failed) asked.delete(id);
  failed.clear();
}

/**
 * Load the takes of the clips that have poses by now, as long as somebody wants them.
 *
 * @param {() => boolean} wanted
 * @param {() => void} found  what to do when those of a clip are there
 */
export function loadTakes(wanted, found) {
  const key = triggerKey(state);
  if (foundBy !== key) {
    foundBy = key;
    takes.clear();
    asked.clear();
  }
  const by = takesLanguage(state.gestures);
  for (const { id, status } of state.clips) {
    if (loading === AT_ONCE || !wanted()) return;
    if (status !== "done" || asked.has(id)) continue;
    asked.add(id);
    loading += 1;
    attempt("Loading the takes", () => api.clips.takes(id, by)).then((list) => {
      loading -= 1;
      if (!list) failed.add(id);
      else if (foundBy === key) takes.set(id, list);
      found();
      loadTakes(wanted, found);
    });
  }
}
