import assert from "node:assert/strict";
import { test } from "node:test";

import { narrow } from "../../../static/js/health/narrowed-report.js";

const report = (labels, pairs) => ({
  gestures: labels.map((label) => ({ label })),
  pairs: pairs.map((gestures) => ({ gestures })),
  map: labels.map((label) => ({ label, x: 0, y: 0 })),
  ok: true,
});

test("a report that fits is shown whole", () => {
  const whole = report(["a", "b"], [["a", "b"]]);
  assert.equal(narrow(whole, 2), whole);
});

test("of a large report the gestures of the most confused pairs are shown", () => {
  const large = report(
    ["a", "b", "c", "d"],
    [
      ["b", "d"],
      ["a", "b"],
      ["c", "d"],
    ],
  );
  const shown = narrow(large, 3);
  assert.deepEqual(
    shown.gestures.map(({ label }) => label),
    ["a", "b", "d"],
  );
  assert.deepEqual(
    shown.pairs.map(({ gestures }) => gestures.join("")),
    ["bd", "ab"],
  );
  assert.equal(shown.map.length, 3);
  assert.equal(shown.ok, true);
});

test("gestures without a compared pair fill up what is left", () => {
  assert.deepEqual(
    narrow(report(["a", "b", "c"], []), 2).gestures.map(({ label }) => label),
    ["a", "b"],
  );
});
