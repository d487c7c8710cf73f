// The drawing over the live picture: the body's skeleton and the hands.

import { svg } from "../core/dom.js";
import { drawPose, skeleton } from "../clips/skeleton.js";

/** @import { Seen } from "./live-messages.d.ts" */

/** Pairs of a hand's landmarks joined by a bone, as positions in `HAND_LANDMARKS`. */
const HAND_BONES = [
  [0, 1],
  [1, 2],
  [2, 3],
  [3, 4],
  [0, 5],
  [5, 6],
  [6, 7],
  [7, 8],
  [5, 9],
  [9, 10],
  [10, 11],
  [11, 12],
  [9, 13],
  [13, 14],
  [14, 15],
  [15, 16],
  [13, 17],
  [0, 17],
  [17, 18],
  [18, 19],
  [19, 20],
];

/**
 * Make an empty drawing over a picture of `width` x `height` pixels.
 *
 * @param {number} width
 * @param {number} height
 */
export function overlay(width, height) {
  const drawing = skeleton(width, height);
  drawing.append(svg("path", { class: "hand-bones", d: "" }));
  return drawing;
}

/**
 * Draw the pose and hands of a message; null clears the drawing.
 *
 * @param {SVGSVGElement} drawing
 * @param {Seen | null} answer
 */
export function drawSeen(drawing, answer) {
  drawPose(drawing, answer?.pose ?? null);
  const { width, height } = drawing.viewBox.baseVal;
  const lines = (answer?.hands ?? []).flatMap((hand) =>
    HAND_BONES.filter(([from, to]) => hand[from] && hand[to]).map((ends) =>
      ends
        .map((end, index) => {
          const [x, y] = hand[end] ?? [0, 0];
          return `${index ? "L" : "M"}${x * width} ${y * height}`;
        })
        .join(""),
    ),
  );
  drawing.querySelector(".hand-bones")?.setAttribute("d", lines.join(""));
  drawing.classList.toggle("saluting", Boolean(answer?.held));
}
