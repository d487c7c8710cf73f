// The picture of one frame: the video under the skeleton; a click on a landmark selects it.

import * as api from "../core/api.js";
import { h, svg } from "../core/dom.js";
import { readable } from "../core/format.js";
import { insideFrame, showFrames } from "../clips/frame-times.js";
import { drawPose, lineThrough, skeleton } from "../clips/skeleton.js";

/** @import { Clip, Poses } from "../core/types.d.ts" */

/** @typedef {{ poses: Poses, body: SVGSVGElement, trails: SVGGElement, circles: SVGCircleElement[] }} Content */

const DOT = 1 / 75; // Radius of a landmark, in the picture's larger side; touchable at 390 px.

/**
 * Build the picture; `onPick(landmark)` is called when one is clicked.
 *
 * @param {(landmark: string) => void} onPick
 */
export function figure(onPick) {
  const video = h("video", { muted: true, playsInline: true, preload: "auto", tabIndex: -1 });
  video.setAttribute("aria-hidden", "true");
  const over = h("div", { className: "figure-over" });
  const element = h("div", { className: "figure" }, video, over);
  /** @type {Content | null} */
  let content = null;
  const frames = showFrames(video);

  /**
   * @param {Poses} poses
   * @param {Clip | null} clip
   */
  function show(poses, clip) {
    const [width, height] = poses.frame_size;
    const radius = Math.max(width, height) * DOT;
    const body = skeleton(width, height);
    const trails = svg("g", { class: "trails" });
    const dots = svg("g", { class: "dots" });
    const circles = poses.landmarks.map((landmark) => {
      const circle = svg("circle", { r: radius, "data-landmark": landmark }, svg("title"));
      circle.onclick = () => onPick(landmark);
      dots.append(circle);
      return circle;
    });
    body.append(trails, dots);
    element.style.setProperty("aspect-ratio", `${width} / ${height}`);
    over.replaceChildren(body);
    content = { poses, body, trails, circles };
    video.hidden = !clip;
    if (clip) frames.load(api.clips.video(clip));
    else video.removeAttribute("src");
  }

  /**
   * The landmarks of a frame in the order of `drawPose`, as shares of the picture.
   *
   * @param {Poses} poses
   * @param {number} frame
   */
  function poseAt(poses, frame) {
    const [width, height] = poses.frame_size;
    const at = new Map(poses.landmarks.map((name, index) => [name, poses.xy[frame][index]]));
    return LANDMARKS.map((name) => {
      const [x, y] = at.get(name) ?? [null, null];
      return x === null || y === null ? null : [x / width, y / height];
    });
  }

  /**
   * @param {number} frame
   * @param {[number, number]} range
   * @param {string[]} chosen
   */
  function draw(frame, [first, last], chosen) {
    if (!content) return;
    const { poses, body, trails, circles } = content;
    drawPose(body, poseAt(poses, frame));
    circles.forEach((circle, index) => {
      const [x, y] = poses.xy[frame][index];
      const name = poses.landmarks[index];
      circle.toggleAttribute("hidden", x === null);
      if (x === null) return;
      circle.setAttribute("cx", String(x));
      circle.setAttribute("cy", String(y));
      circle.classList.toggle("on", chosen.includes(name));
      const title = circle.querySelector("title");
      if (title)
        title.textContent = `${readable(name)}: ${chosen.includes(name) ? "followed; click to leave it out" : "click to follow it"}`;
    });
    trails.replaceChildren(
      ...chosen.map((name) =>
        svg("path", { d: trail(poses, poses.landmarks.indexOf(name), first, last) }),
      ),
    );
    const [begin, inside] = [poses.time[frame], insideFrame(poses.time, frame)];
    if (!video.hidden) frames.show({ begin, inside });
  }

  /**
   * @param {Poses} poses
   * @param {number} index
   * @param {number} first
   * @param {number} last
   */
  const trail = ({ xy }, index, first, last) =>
    index < 0 ? "" : lineThrough(xy.slice(first, last + 1).map((points) => points[index]));
  return { element, show, draw };
}

/** The landmarks in the order of `BONES`: `POSE_LANDMARKS` in poses/landmarks.py of the core. */
const LANDMARKS = [
  "nose",
  "left_eye_inner",
  "left_eye",
  "left_eye_outer",
  "right_eye_inner",
  "right_eye",
  "right_eye_outer",
  "left_ear",
  "right_ear",
  "mouth_left",
  "mouth_right",
  ...[
    "shoulder",
    "elbow",
    "wrist",
    "pinky",
    "index",
    "thumb",
    "hip",
    "knee",
    "ankle",
    "heel",
    "foot_index",
  ].flatMap((part) => [`left_${part}`, `right_${part}`]),
];
