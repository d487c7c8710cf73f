// What a gesture is made of, in words.

import assert from "node:assert/strict";
import { test } from "node:test";

import { isHeld, listFollowed } from "../../../static/js/gestures/held-shape.js";

test("a gesture without salient keypoints and with a demonstration is a held hand shape", () => {
  assert.equal(listFollowed({ salient: [], has_trajectory: true }), "held hand shape");
  assert.equal(listFollowed({ salient: [], seconds: 2 }), "held hand shape");
});

test("a movement is listed by its keypoints, an imported image by none", () => {
  assert.equal(listFollowed({ salient: ["right_wrist"], has_trajectory: true }), "right wrist");
  assert.equal(isHeld({ salient: [], has_trajectory: false }), false);
  assert.equal(isHeld({ salient: [], seconds: null }), false);
});
