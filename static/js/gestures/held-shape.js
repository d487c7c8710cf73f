// What a gesture is made of: the keypoints that are followed, or a held hand shape.

import { readable } from "../core/format.js";

/**
 * Whether nothing moves in it, and the hand's shape is the gesture.
 *
 * @param {{ salient: string[], has_trajectory?: boolean, seconds?: number | null }} shown
 */
export function isHeld({ salient, has_trajectory: kept, seconds }) {
  return !salient.length && (kept ?? seconds !== null);
}

/** @param {Parameters<typeof isHeld>[0]} shown */
export function listFollowed(shown) {
  return isHeld(shown) ? "held hand shape" : shown.salient.map(readable).join(", ");
}
