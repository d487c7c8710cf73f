import assert from "node:assert/strict";
import { test } from "node:test";

import { shownRows, sortedRows } from "../../../static/js/export/take-rows.js";

/** @type {any[]} */
const ROWS = [
  { take: 1, label: "line", confidence: 0.4, faults: "" },
  { take: 2, label: null, confidence: 0.9, faults: "dark" },
  { take: null, label: null, confidence: null, faults: "no take found" },
  { take: 1, label: "circle", confidence: 0.7, faults: "" },
  { take: 2, label: null, pair: "circle or line", confidence: 0.5, faults: "" },
];

test("a clip without a take is not rejected, and neither is a take between two gestures", () => {
  assert.deepEqual(shownRows(ROWS, "rejected"), [ROWS[1]]);
  assert.deepEqual(shownRows(ROWS, "asked"), [ROWS[4]]);
  assert.deepEqual(shownRows(ROWS, "=circle"), [ROWS[3]]);
  assert.deepEqual(shownRows(ROWS, "faults"), [ROWS[1], ROWS[2]]);
  assert.equal(shownRows(ROWS, "").length, 5);
});

test("rows without a value come last in either order", () => {
  const order = (/** @type {boolean} */ down) =>
    sortedRows(ROWS, "confidence", down).map(({ confidence }) => confidence);
  assert.deepEqual(order(false), [0.4, 0.5, 0.7, 0.9, null]);
  assert.deepEqual(order(true), [0.9, 0.7, 0.5, 0.4, null]);
});
