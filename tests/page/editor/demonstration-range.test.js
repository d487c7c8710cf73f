import assert from "node:assert/strict";
import { test } from "node:test";

import {
  framesOf,
  movedTo,
  takeOf,
  wholeOf,
} from "../../../static/js/editor/demonstration-range.js";

const TIME = Array.from({ length: 101 }, (_, frame) => frame / 25);
const TAKES = [{ start: 0.4, end: 3.6, stroke_start: 0.8, stroke_end: 3.2 }];

test("of a take the gesture without its transit is meant, unless that is kept", () => {
  const whole = wholeOf("c", TAKES, TIME);
  assert.equal(takeOf(whole, TAKES), TAKES[0]);
  assert.deepEqual(framesOf(whole, TAKES, TIME), [20, 80]);
  assert.deepEqual(framesOf({ ...whole, keep_transit: true }, TAKES, TIME), [10, 90]);
});

test("without a take all of the clip is meant", () => {
  assert.deepEqual(framesOf(wholeOf("c", [], TIME), [], TIME), [0, 100]);
});

test("an end that is moved makes a range by hand of at least three frames", () => {
  const whole = wholeOf("c", TAKES, TIME);
  const moved = movedTo(whole, TAKES, TIME, "start", 95);
  assert.equal(takeOf(moved, TAKES), null);
  assert.deepEqual(framesOf(moved, TAKES, TIME), [78, 80]);
  assert.deepEqual(framesOf(movedTo(whole, TAKES, TIME, "end", 999), TAKES, TIME), [20, 100]);
});

test("of a demonstration as the language keeps it all is meant, beside any clip's takes", () => {
  assert.equal(takeOf(null, TAKES), null);
  assert.deepEqual(framesOf(null, TAKES, TIME), [0, 100]);
});
