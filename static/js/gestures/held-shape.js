// What a gesture is made of: the keypoints that are followed, or one or two held hand shapes.

import { readable } from "../core/format.js";

/**
 * Whether nothing moves in it, and the hand's shape is the gesture.
 *
 * @param {{ held_shapes: number }} shown
 */
export function isHeld({ held_shapes: count }) {
  return count > 0;
}

/** @param {{ held_shapes: number, salient: string[] }} shown */
export function listFollowed(shown) {
  if (shown.held_shapes > 1) return "two held hand shapes in sequence";
  return isHeld(shown) ? "held hand shape" : shown.salient.map(readable).join(", ");
}

/**
 * How a held gesture is drawn, for those who do not see the picture.
 *
 * @param {{ held_shapes: number }} shown
 */
export function nameShapes({ held_shapes: count }) {
  return count > 1 ? "two hand shapes, from the first along the arrow" : "a hand shape";
}
