import assert from "node:assert/strict";
import { test } from "node:test";

import { linePath, topSpeed } from "../../../static/js/studio/timeline-curves.js";

test("a line is interrupted where there is no value", () => {
  const path = linePath([0, 1, null, 2], 2, (index) => index);
  assert.equal(path, "M0 30.00L1 15.00M3 0.00");
});

test("a value above the top is drawn at the top", () => {
  assert.equal(
    linePath([5], 2, () => 0),
    "M0 0.00",
  );
});

test("one landmark that jumps does not flatten the other frames", () => {
  const calm = Array.from({ length: 99 }, () => 2);
  assert.equal(topSpeed({ speed: { right_wrist: [...calm, 400], left_wrist: [] } }), 2);
});

test("hands at rest are not drawn as if they moved", () => {
  assert.equal(topSpeed({ speed: { right_wrist: [0.01, null], left_wrist: [null] } }), 0.5);
});
