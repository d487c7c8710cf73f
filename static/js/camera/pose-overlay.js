// The drawing over the live picture: the body's skeleton and the hands.

import { svg } from "../core/dom.js";
import { bonesAlong, drawPose, skeleton } from "../clips/skeleton.js";

/** @import { Seen } from "./live-messages.d.ts" */

/** The bones of the palm and the fingers, as positions in `HAND_LANDMARKS` of the core. */
const HAND_BONES = bonesAlong([
  [0, 1, 2, 3, 4],
  [0, 5, 6, 7, 8],
  [5, 9, 10, 11, 12],
  [9, 13, 14, 15, 16],
  [13, 17, 18, 19, 20],
  [0, 17],
]);

/**
 * Make an empty drawing that lies over the picture of a video.
 *
 * @param {HTMLVideoElement} video
 */
export function overlay(video) {
  const drawing = skeleton(video.videoWidth, video.videoHeight);
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
