// The takes of the library's clips, for making gestures: loaded a few clips at a time.

import { takesLanguage } from "../clips/salutes.js";
import { versionOf } from "../clips/clip-store.js";
import * as api from "../core/api.js";
import { state } from "../core/state.js";
import { complain } from "../core/toasts.js";
import { triggerKey } from "../languages/language-trigger.js";

/** @import { Clip, Take } from "../core/types.d.ts" */

const AT_ONCE = 4; // A library has hundreds of clips; other requests must not wait.

/** @type {Map<string, Take[]>} */
export const takesByClip = new Map(); // they change with the language's trigger alone
/** @type {Set<string>} */
const asked = new Set(); // by `versionOf` the clip
/** @type {Set<string>} */
const failed = new Set();
let foundBy = ""; // the trigger by which they were found
let loading = 0;

/** Let the next call retry the takes that could not be loaded. */
export function forgetFailures() {
  for (const id of failed) asked.delete(id);
  failed.clear();
}

/**
 * Load the takes of the clips whose poses are found, as long as `wanted()` is true.
 *
 * @param {() => boolean} wanted
 * @param {() => void} found  called when the takes of a clip are loaded
 */
export function loadTakesOfClips(wanted, found) {
  const key = triggerKey(state);
  if (foundBy !== key) {
    foundBy = key;
    takesByClip.clear();
    asked.clear();
    failed.clear();
  }
  const by = takesLanguage(state.gestures);
  for (const clip of state.clips) {
    if (loading === AT_ONCE || !wanted()) return;
    if (clip.status !== "done" || asked.has(versionOf(clip))) continue;
    loadOne(clip, by, key).then((away) => {
      found();
      if (!away) loadTakesOfClips(wanted, found);
    });
  }
}

/**
 * Load the takes of one clip; an answer for a former trigger is dropped.
 *
 * @param {Clip} clip
 * @param {string | null} by  the language whose trigger it is
 * @param {string} key  of that trigger
 * @returns {Promise<boolean>} whether the server is away, which does not count as a failure of this
 * clip
 */
async function loadOne(clip, by, key) {
  const asking = versionOf(clip);
  asked.add(asking);
  loading += 1;
  try {
    const list = await api.clips.takes(clip.id, by);
    if (foundBy === key) takesByClip.set(clip.id, list);
    return false;
  } catch (error) {
    const away = api.isAway(error);
    if (foundBy === key) {
      if (away) asked.delete(asking);
      else failed.add(asking);
    }
    if (!away) complain(error, "Loading the takes");
    return away;
  } finally {
    loading -= 1;
  }
}
