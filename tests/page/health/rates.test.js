import assert from "node:assert/strict";
import { test } from "node:test";

import { percent, rateText } from "../../../static/js/health/rates.js";

test("a half is rounded to the even number, as in the findings' own words", () => {
  assert.deepEqual([0.005, 0.015, 0.025, 0.125, 0.135].map(percent), ["<1", "2", "2", "12", "14"]);
});

test("a rate above 0 is never written as 0", () => {
  assert.deepEqual([0, 0.001, 1].map(percent), ["0", "<1", "100"]);
});

test("an interval whose ends read the same is left out", () => {
  assert.equal(rateText({ rate: 0.001, low: 0.0005, high: 0.004 }), "<1 %");
  assert.equal(rateText({ rate: 0.2, low: 0.13, high: 0.26 }), "20 % (13 to 26)");
});
