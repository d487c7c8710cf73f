// What a gesture is made of, in words.

import assert from "node:assert/strict";
import { test } from "node:test";

import { isHeld, listFollowed, nameShapes } from "../../../static/js/gestures/held-shape.js";

test("a gesture that holds one shape is a held hand shape", () => {
  const shown = { salient: [], held_shapes: 1 };
  assert.equal(isHeld(shown), true);
  assert.equal(listFollowed(shown), "held hand shape");
  assert.equal(nameShapes(shown), "a hand shape");
});

test("a movement is listed by its keypoints, an imported image by none", () => {
  assert.equal(listFollowed({ salient: ["right_wrist"], held_shapes: 0 }), "right wrist");
  assert.equal(listFollowed({ salient: [], held_shapes: 0 }), "");
  assert.equal(isHeld({ held_shapes: 0 }), false);
});

test("two held hand shapes are a sequence, in words and for those who do not see the picture", () => {
  const shown = { salient: [], held_shapes: 2 };
  assert.equal(isHeld(shown), true);
  assert.equal(listFollowed(shown), "two held hand shapes in sequence");
  assert.equal(nameShapes(shown), "two hand shapes, from the first along the arrow");
});
