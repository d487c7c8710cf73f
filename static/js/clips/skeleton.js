// The skeleton over a picture: bones as lines, landmarks as dots.

import { svg } from "../core/dom.js";

/**
 * Pairs of landmarks joined by a bone: `SKELETON` in poses/landmarks.py of the core, as positions
 * in `POSE_LANDMARKS`.
 */
export const BONES = [
  [11, 12],
  [11, 13],
  [13, 15],
  [12, 14],
  [14, 16],
  [15, 19],
  [15, 17],
  [15, 21],
  [16, 20],
  [16, 18],
  [16, 22],
  [11, 23],
  [12, 24],
  [23, 24],
  [23, 25],
  [25, 27],
  [24, 26],
  [26, 28],
  [27, 31],
  [28, 32],
];

/**
 * Make an empty drawing that lies over a picture of `width` x `height` pixels.
 *
 * @param {number} width
 * @param {number} height
 * @returns {SVGSVGElement}
 */
export function skeleton(width, height) {
  return svg(
    "svg",
    { class: "skeleton", viewBox: `0 0 ${width} ${height}`, "aria-hidden": "true" },
    svg("path", { class: "bones", d: "" }),
    svg("path", { class: "landmarks", d: "" }),
  );
}

/**
 * Draw a pose instead of the one before; null clears the drawing. A pose has [x, y] of every
 * landmark as fractions of the picture's width and height, and null for one that was not seen.
 *
 * @param {SVGSVGElement} drawing
 * @param {(number[] | null)[] | null} pose
 */
export function drawPose(drawing, pose) {
  const { width, height } = drawing.viewBox.baseVal;
  const points = (pose ?? []).map(
    (landmark) => landmark && `${landmark[0] * width} ${landmark[1] * height}`,
  );
  const bones = BONES.filter(([from, to]) => points[from] && points[to]);
  drawing
    .querySelector(".bones")
    ?.setAttribute("d", bones.map(([from, to]) => `M${points[from]}L${points[to]}`).join(""));
  // A line without length has round ends: a dot.
  drawing.querySelector(".landmarks")?.setAttribute(
    "d",
    points
      .filter(Boolean)
      .map((point) => `M${point}h0`)
      .join(""),
  );
}
