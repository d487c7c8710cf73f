import assert from "node:assert/strict";
import { test } from "node:test";

import { narrow } from "../../../static/js/health/narrowed-report.js";

const report = (distances) => ({
  gestures: Object.entries(distances).map(([label, distance]) => ({
    label,
    nearest: distance === null ? null : { label: "other", distance },
  })),
  map: Object.keys(distances).map((label) => ({ label, x: 0, y: 0 })),
});

const labels = (points) => points.map(({ label }) => label);

test("a report that fits is shown whole, in the language's order", () => {
  assert.deepEqual(labels(narrow(report({ a: 2, b: 1 }), 2)), ["a", "b"]);
});

test("of a large report the gestures that are nearest to another are on the map", () => {
  assert.deepEqual(labels(narrow(report({ a: 0.5, b: 0.2, c: 0.9, d: 0.3 }), 2)), ["b", "d"]);
});

test("gestures without a comparable one fill up what is left", () => {
  assert.deepEqual(labels(narrow(report({ a: null, b: 0.2, c: null }), 2)), ["a", "b"]);
});
