import assert from "node:assert/strict";
import { test } from "node:test";

import { pairName, pairOf } from "../../../static/js/health/finding-links.js";

test("two labels come back from the address, whatever they contain", () => {
  for (const pair of [
    ["circle", "line"],
    ["up, slowly", "100 %"],
    ["größer", "a/b?c=d&e"],
  ]) {
    assert.deepEqual(pairOf(pairName(...pair)), pair);
  }
});

test("what names no pair is no pair", () => {
  assert.deepEqual([null, "", "circle", "a,b,c", "%,a"].map(pairOf), [
    null,
    null,
    null,
    null,
    null,
  ]);
});
