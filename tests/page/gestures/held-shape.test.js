// What a gesture is made of, in words.

import assert from "node:assert/strict";
import { test } from "node:test";

import { isHeld, listFollowed, nameShapes } from "../../../static/js/gestures/held-shape.js";

test("a gesture without salient keypoints and with a demonstration is a held hand shape", () => {
  assert.equal(
    listFollowed({ salient: [], has_trajectory: true, held_shapes: 1 }),
    "held hand shape",
  );
  assert.equal(listFollowed({ salient: [], seconds: 2, held_shapes: 1 }), "held hand shape");
});

test("a movement is listed by its keypoints, an imported image by none", () => {
  assert.equal(listFollowed({ salient: ["right_wrist"], held_shapes: 0 }), "right wrist");
  assert.equal(isHeld({ salient: [], has_trajectory: false }), false);
  assert.equal(isHeld({ salient: [], seconds: null }), false);
});

test("two held hand shapes are a sequence, in words and for those who do not see the picture", () => {
  const shown = { salient: [], seconds: 4, held_shapes: 2 };
  assert.equal(isHeld(shown), true);
  assert.equal(listFollowed(shown), "two held hand shapes in sequence");
  assert.equal(nameShapes(shown), "two hand shapes, from the first along the arrow");
  assert.equal(nameShapes({ held_shapes: 1 }), "a hand shape");
});
