import assert from "node:assert/strict";
import { test } from "node:test";

import { follow, queueOf, secondsLeft } from "../../../static/js/clips/batch.js";

const clip = (number, status, frames = 100) => ({
  id: `c${number}`,
  job_id: `j${number}`,
  created: `2026-01-01T00:00:0${number}`,
  status,
  frames,
});
const jobs = (done) => new Map([["j1", { done }]]);

test("the time for all clips follows from the frames done since the batch began", () => {
  const clips = [clip(1, "running"), clip(2, "queued"), clip(3, "queued", null)];
  let batch = follow(null, clips, jobs(0), 0);
  assert.equal(secondsLeft(batch), null);
  batch = follow(batch, clips, jobs(10), 4000);
  assert.equal(secondsLeft(batch), null);
  batch = follow(batch, clips, jobs(60), 14000);
  // Five frames a second; 40, 100 and 200 are left.
  assert.equal(secondsLeft(batch), 68);
});

test("clips that are done stay in the batch until none is busy", () => {
  let batch = follow(null, [clip(1, "running"), clip(2, "queued")], jobs(50), 0);
  batch = follow(batch, [clip(1, "done"), clip(2, "running")], new Map(), 1000);
  assert.deepEqual(batch.members, ["c1", "c2"]);
  assert.equal(batch.frames, 100);
  assert.equal(follow(batch, [clip(1, "done"), clip(2, "done")], new Map(), 2000), null);
});

test("the oldest clip is the next", () => {
  const queue = queueOf([clip(3, "queued"), clip(2, "queued"), clip(1, "running")]);
  assert.deepEqual(
    queue.map(({ id }) => id),
    ["c2", "c3"],
  );
});
