import assert from "node:assert/strict";
import { test } from "node:test";

import { chooseJoint, partsOf, roleOf } from "../../../static/js/studio/alignment-parts.js";

const STEPS = 20;
const circle = (size) =>
  Array.from({ length: STEPS }, (_, step) => [
    size * Math.cos((2 * Math.PI * step) / STEPS),
    size * Math.sin((2 * Math.PI * step) / STEPS),
  ]);
const [still, moving, elbow] = [circle(0.005), circle(1), circle(0.5)];

// The joint at rest differs most, as when a take is compared with itself.
const ALIGNMENT = {
  parts: ["left_wrist", "right_wrist", "right_elbow"],
  costs: [[0.002, 0.001, 0.0005]],
  query: still.map((_, step) => [still[step], moving[step], elbow[step]]),
};
const PARTS = partsOf(ALIGNMENT);
const choose = (chosen, before) => chooseJoint(PARTS, [ALIGNMENT], chosen, before).name;

test("a joint at rest is not drawn unless it is chosen", () => {
  assert.equal(PARTS[0].name, "left_wrist");
  assert.equal(choose(null, null), "right_wrist");
  assert.equal(choose(null, "left_wrist"), "right_wrist");
  assert.equal(choose("left_wrist", null), "left_wrist");
});

test("another recognition of the take keeps the joint", () => {
  assert.equal(choose(null, "right_elbow"), "right_elbow");
});

test("beside an expected gesture that is nearest stands the runner-up", () => {
  assert.equal(roleOf("circle", { expected: "square", nearest: "square" }), "runner-up");
  assert.equal(roleOf("circle", { expected: "square", nearest: "circle" }), "nearest");
  assert.equal(roleOf("square", { expected: "square", nearest: "circle" }), "expected");
});
