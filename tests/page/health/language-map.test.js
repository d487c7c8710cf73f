import assert from "node:assert/strict";
import { test } from "node:test";

import { apart, narrow } from "../../../static/js/health/language-map.js";

const SIZE = 40;

test("thumbnails at one place are moved apart and stay in the drawing", () => {
  const places = Array.from({ length: 12 }, () => ({ x: 300, y: 210 }));
  const moved = apart(places, SIZE);
  for (const [index, one] of moved.entries()) {
    assert.ok(one.x > 0 && one.x < 600 && one.y > 0 && one.y < 420);
    for (const other of moved.slice(index + 1)) {
      const [dx, dy] = [Math.abs(one.x - other.x), Math.abs(one.y - other.y)];
      assert.ok(dx >= SIZE || dy >= SIZE, `${dx}, ${dy}`);
    }
  }
});

test("thumbnails that do not overlap stay where they are", () => {
  const places = [
    { x: 100, y: 100 },
    { x: 400, y: 300 },
  ];
  assert.deepEqual(apart(places, SIZE), places);
});

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
