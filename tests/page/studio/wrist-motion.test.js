import assert from "node:assert/strict";
import { test } from "node:test";

import { movingWrists, tracksOf } from "../../../static/js/studio/wrist-motion.js";

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
