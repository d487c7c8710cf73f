// Uploads that had arrived when a reload took them for unsent: chosen again they would be double.

import { tabStore } from "../core/browser-store.js";

/** @import { Clip } from "../core/types.d.ts" */

const UNSENT = "osg-studio.unsent"; // as in upload-list.js
const LATELY = 600_000; // ms before the page was loaded

/**
 * Forget the names of files that are clips since shortly before this page was loaded.
 *
 * @param {Clip[]} clips
 */
export function forgetArrived(clips) {
  const since = performance.timeOrigin - LATELY;
  const arrived = clips.filter(({ created }) => Date.parse(created) > since);
  /** @type {string[]} */
  const left = [...(tabStore.read(UNSENT) ?? [])];
  for (const { name } of arrived) {
    const at = left.indexOf(name);
    if (at >= 0) left.splice(at, 1);
  }
  tabStore.write(UNSENT, left);
}
