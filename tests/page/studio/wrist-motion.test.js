import assert from "node:assert/strict";
import { test } from "node:test";

import { movingWrists, strokeOver, tracksOf } from "../../../static/js/studio/wrist-motion.js";

// Four frames: the left wrist rests, the right one goes 40 to the right and 20 up, once unseen.
const POSES = {
  landmarks: ["nose", "left_wrist", "right_wrist"],
  xy: [
    [
      [50, 10],
      [20, 80],
      [60, 80],
    ],
    [
      [50, 10],
      [21, 80],
      [80, 70],
    ],
    [
      [50, 10],
      [20, 80],
      [null, null],
    ],
    [
      [50, 10],
      [20, 80],
      [100, 60],
    ],
  ],
};

test("a wrist that rests is no part of the stroke", () => {
  assert.deepEqual(movingWrists(POSES, [0, 3]), ["right_wrist"]);
  assert.deepEqual(movingWrists({ landmarks: ["nose"], xy: POSES.xy }, [0, 3]), []);
});

test("a track goes to the right and upwards, both in shares of the largest extent", () => {
  const [track] = tracksOf(POSES, ["right_wrist"]);
  assert.deepEqual(track.x, [0, 0.5, null, 1]);
  assert.deepEqual(track.y, [0, 0.25, null, 0.5]);
});

test("the tracks of two wrists compare", () => {
  const [left, right] = tracksOf(POSES, ["left_wrist", "right_wrist"]);
  assert.deepEqual([Math.max(...left.x), Math.max(...right.x)], [1 / 40, 1]);
});

test("a gesture is laid over the take by the size and place of the diver in the picture", () => {
  // A right angle, shown 30 times larger, about (100, 50).
  const query = [[[-1, 0]], [null], [[0, 0]], [[1, 1]]];
  const shown = query.map(([place]) => place && [100 + 30 * place[0], 50 + 30 * place[1]]);
  const poses = {
    landmarks: ["nose", "right_wrist"],
    time: [0, 0.1, 0.2, 0.3, 0.4],
    xy: [[null, null], ...shown.map((place) => place ?? [null, null])].map((at) => [[5, 5], at]),
  };
  const time = [0.1, 0.2, 0.3, 0.4];
  const parts = ["right_elbow", "right_wrist"];
  const both = (steps) => steps.map(([place]) => [[9, 9], place]);
  const gesture = [[[-1, 0]], [null], [[1, -1]]];
  const [path, ...others] = strokeOver(
    { parts, time, query: both(query), gesture: both(gesture) },
    poses,
  );
  assert.deepEqual(others, []);
  const rounded = path.map((place) => place && place.map((value) => Math.round(value)));
  assert.deepEqual(rounded, [[70, 50], null, [130, 20]]);
  assert.deepEqual(strokeOver({ parts: ["nose"], time, query, gesture }, poses), []);
});
