import assert from "node:assert/strict";
import { test } from "node:test";

import { apart } from "../../../static/js/health/language-map.js";

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
