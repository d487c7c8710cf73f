import assert from "node:assert/strict";
import { test } from "node:test";

import {
  ago,
  bytes,
  duration,
  moment,
  plural,
  readable,
  timeLeft,
} from "../../../static/js/core/format.js";

test("bytes are written in the unit that is readable", () => {
  assert.deepEqual([999, 1000, 1e6, 2.345e9].map(bytes), ["999 B", "1 kB", "1.0 MB", "2.35 GB"]);
});

test("a duration of a minute or more has minutes, also where its seconds round up", () => {
  const written = [0.25, 9.96, 10.4, 59.9, 60, 119.6, 3725].map(duration);
  assert.deepEqual(written, [
    "0.3 s",
    "10.0 s",
    "10 s",
    "60 s",
    "1 min 00 s",
    "2 min 00 s",
    "62 min 05 s",
  ]);
});

test("the time left is never told shorter than it is", () => {
  assert.deepEqual([0.2, 1.2, 59.2, 61].map(timeLeft), [
    "almost done",
    "2 s left",
    "60 s left",
    "1 min 01 s left",
  ]);
});

test("a moment in a clip has hundredths", () => assert.equal(moment(1.005 + 1), "2.00 s"));

test("a past moment is told in the largest unit that fits", () => {
  const before = (seconds) => ago(new Date(Date.now() - 1000 * seconds).toISOString());
  assert.equal(before(5), "just now");
  assert.equal(before(120), "2 minutes ago");
  assert.equal(before(2 * 86400), "2 days ago");
});

test("identifiers and counts are written as words", () => {
  assert.equal(readable("right_foot_index"), "right foot index");
  assert.deepEqual(
    [0, 1, 2].map((count) => plural(count, "clip")),
    ["0 clips", "1 clip", "2 clips"],
  );
});
