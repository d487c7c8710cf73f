// A demonstration as a drawing: the diver's arms at one moment, and the paths of the hands.

import { lineThrough } from "../clips/skeleton.js";
import { svg } from "../core/dom.js";

/** @import { PairDifference, Place } from "../core/types.d.ts" */

/** @typedef {PairDifference["gestures"][number]} Paths */

/** @typedef {NonNullable<ReturnType<typeof boxOf>>} Box */

const MARGIN = 0.15; // Torso lengths around all that moves.

const BONES = [
  ["left_shoulder", "right_shoulder"],
  ["left_shoulder", "left_elbow"],
  ["left_elbow", "left_wrist"],
  ["left_wrist", "left_index"],
  ["right_shoulder", "right_elbow"],
  ["right_elbow", "right_wrist"],
  ["right_wrist", "right_index"],
];

/**
 * The box around all places of some gestures, so that all are drawn at one scale.
 *
 * @param {Paths[]} gestures
 */
export function boxOf(gestures) {
  const places = gestures
    .flatMap(({ paths }) => Object.values(paths).flat())
    .filter((place) => place !== null);
  if (!places.length) return null;
  const [xs, ys] = [places.map(([x]) => x), places.map(([, y]) => y)];
  const [left, top] = [Math.min(...xs) - MARGIN, Math.min(...ys) - MARGIN];
  return {
    left,
    top,
    width: Math.max(...xs) + MARGIN - left,
    height: Math.max(...ys) + MARGIN - top,
  };
}

/**
 * The place of a landmark at a moment; null where it was not seen.
 *
 * @param {Paths} gesture
 * @param {Place[]} path
 * @param {number} seconds
 * @returns {Place}
 */
function placeAt({ time }, path, seconds) {
  const after = time.findIndex((each) => each >= seconds);
  if (after < 0) return path.at(-1) ?? null;
  if (after === 0) return path[0];
  const [from, to] = [path[after - 1], path[after]];
  if (!from || !to) return null;
  const share = (seconds - time[after - 1]) / (time[after] - time[after - 1]);
  return [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])];
}

/**
 * Make a drawing of a gesture; `show(seconds)` moves it to a moment.
 *
 * @param {Paths} gesture
 * @param {Box} box
 */
export function movingPaths(gesture, box) {
  const { time, paths, salient, label } = gesture;
  const followed = salient.filter((name) => paths[name]);
  /**
   * @param {string} name
   * @param {string} [d]
   */
  const path = (name, d = "") => svg("path", { class: name, d });
  const [bones, trail, dots] = [path("bones"), path("trail"), path("dots")];
  const whole = path("whole", followed.map((name) => lineThrough(paths[name])).join(""));
  const drawing = svg(
    "svg",
    {
      class: "paths",
      viewBox: `${box.left} ${box.top} ${box.width} ${box.height}`,
      role: "img",
      "aria-label": `The movement of ${label}`,
    },
    bones,
    whole,
    trail,
    dots,
  );
  /** @param {number} seconds */
  const show = (seconds) => {
    /** @param {string} name */
    const at = (name) => (paths[name] ? placeAt(gesture, paths[name], seconds) : null);
    const passed = time.findLastIndex((each) => each <= seconds);
    bones.setAttribute(
      "d",
      BONES.filter(([from, to]) => at(from) && at(to))
        .map(([from, to]) => lineThrough([at(from), at(to)]))
        .join(""),
    );
    trail.setAttribute(
      "d",
      followed.map((name) => lineThrough([...paths[name].slice(0, passed + 1), at(name)])).join(""),
    );
    // A line without length has round ends: a dot.
    dots.setAttribute(
      "d",
      followed
        .map(at)
        .filter((place) => place !== null)
        .map(([x, y]) => `M${x} ${y}h0`)
        .join(""),
    );
  };
  return { drawing, show };
}
