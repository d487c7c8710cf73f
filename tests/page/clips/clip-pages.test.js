import assert from "node:assert/strict";
import { test } from "node:test";

import { countAll, isListed, merged } from "../../../static/js/clips/clip-pages.js";

const clip = (number, status = "done") => ({
  id: `c${number}`,
  created: `2026-01-01T00:00:0${number}`,
  status,
});
const ids = (clips) => clips.map(({ id }) => id);

test("clips are kept once, newest first, as they were loaded last", () => {
  const known = merged([clip(1), clip(3, "queued")], [clip(2), clip(3, "done")]);
  assert.deepEqual(ids(known), ["c3", "c2", "c1"]);
  assert.equal(known[0].status, "done");
});

test("a clip beyond those that are known without gaps is not listed, and counted once", () => {
  const known = { clips: [clip(5), clip(4), clip(1)], library: { last: clip(4), older: 3 } };
  assert.deepEqual(ids(known.clips.filter((each) => isListed(each, known))), ["c5", "c4"]);
  assert.equal(countAll(known), 5);
  const all = { ...known, library: { last: null, older: 0 } };
  assert.equal(countAll(all), 3);
});
