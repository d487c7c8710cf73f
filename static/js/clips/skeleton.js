// The skeleton over a picture: bones as lines, landmarks as dots.

import { svg } from "../core/dom.js";

/**
 * Bones, as pairs of landmarks, along the chains of joints from the body outwards.
 *
 * @param {number[][]} chains
 */
export const bonesAlong = (chains) =>
  chains.flatMap((chain) => chain.slice(1).map((end, index) => [chain[index], end]));

/** The bones in `SKELETON` of poses/landmarks.py of the core, as positions in `POSE_LANDMARKS`. */
export const BONES = bonesAlong([
  [11, 12],
  [11, 13, 15, 19],
  [15, 17],
  [15, 21],
  [12, 14, 16, 20],
  [16, 18],
  [16, 22],
  [11, 23, 25, 27, 31],
  [12, 24, 26, 28, 32],
  [23, 24],
]);

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

/**
 * A line through places, interrupted where one is missing.
 *
 * @param {((number | null)[] | null)[]} places
 */
export function lineThrough(places) {
  let down = false;
  return places
    .map((place) => {
      const [x, y] = place ?? [];
      const isSeen = typeof x === "number" && typeof y === "number";
      const command = isSeen ? `${down ? "L" : "M"}${x.toFixed(3)} ${y.toFixed(3)}` : "";
      down = isSeen;
      return command;
    })
    .join("");
}
