// The content of a gesture in words: the salient keypoints, or one or two held hand shapes.

import { readable } from "../core/format.js";

/**
 * Whether the gesture is a held hand shape, without movement.
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
 * The alternative text of a held gesture's picture.
 *
 * @param {{ held_shapes: number }} shown
 */
export function nameShapes({ held_shapes: count }) {
  return count > 1 ? "two hand shapes, from the first along the arrow" : "a hand shape";
}
