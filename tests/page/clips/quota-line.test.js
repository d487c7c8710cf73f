import assert from "node:assert/strict";
import { test } from "node:test";

import { describeQuota } from "../../../static/js/clips/quota-line.js";

test("a quota tells what is used of what it limits", () => {
  const quota = { clips: 3, most_clips: 10, bytes: 0, most_bytes: 0 };
  assert.equal(describeQuota(quota), "Your quota: 3 of 10 clips used");
  const both = { ...quota, bytes: 12e6, most_bytes: 20e6 };
  assert.match(describeQuota(both), /^Your quota: 1[12].* of (19|20).*, 3 of 10 clips used$/);
});
