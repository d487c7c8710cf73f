import assert from "node:assert/strict";
import { test } from "node:test";

import { supportOf } from "../../../static/js/studio/vote-support.js";

test("the support of a gesture is the weight of its voters, not their number", () => {
  const support = supportOf({
    votes: { path: "circle", hu: "line", tempo: "line", zernike: "line", hand: null },
    weights: { path: 0.4, hu: 0.05, tempo: 0.05, zernike: 0, hand: 0.5 },
  });
  assert.equal(support.get("circle"), 0.8);
  assert.equal(support.get("line"), 0.2);
});
