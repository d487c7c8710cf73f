import assert from "node:assert/strict";
import { test } from "node:test";

import { howTo, isSlow, situation } from "../../../static/js/camera/take-steps.js";

const pose = [];
const wordsOf = (seen, kind) =>
  situation({ pose, salute: 0, held: false, state: "idle", ...seen }, kind)[1];

test("a diver is told what is seen of a take, step by step", () => {
  assert.equal(wordsOf({ pose: null }), "Nobody is in the picture.");
  assert.equal(wordsOf({}), "Waiting for a Vulcan salute.");
  assert.equal(wordsOf({ salute: 0.9 }), "Salute seen. Hold it.");
  assert.match(wordsOf({ state: "recording", held: true }), /^Salute held/);
  assert.match(wordsOf({ state: "recording" }), /^Show the gesture/);
  assert.match(wordsOf({ state: "recording", salute: 0.9 }), /^Closing salute seen/);
  assert.match(wordsOf({ state: "done" }), /^Gesture taken/);
});

test("each trigger has words of its own", () => {
  assert.equal(wordsOf({}, "pose"), "Waiting for the pose of the arms.");
  for (const kind of ["gesture", "none"]) assert.equal(wordsOf({}, kind), "Show a gesture.");
  assert.equal(new Set(["salute", "pose", "gesture", "none"].map(howTo)).size, 4);
});

test("six frames a second are enough", () => {
  assert.deepEqual(
    [5.9, 6].map((rate) => isSlow({ frames_per_second: rate })),
    [true, false],
  );
});
