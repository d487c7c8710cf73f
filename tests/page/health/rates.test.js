import assert from "node:assert/strict";
import { test } from "node:test";

import { percent } from "../../../static/js/health/rates.js";

test("a half is rounded to the even number, as in the findings' own words", () => {
  assert.deepEqual([0.005, 0.015, 0.025, 0.125, 0.135].map(percent), ["<1", "2", "2", "12", "14"]);
});

test("a rate above 0 is never written as 0", () => {
  assert.deepEqual([0, 0.001, 1].map(percent), ["0", "<1", "100"]);
});
