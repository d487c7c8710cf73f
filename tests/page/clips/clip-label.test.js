import assert from "node:assert/strict";
import { test } from "node:test";

import { labelInName } from "../../../static/js/clips/clip-label.js";

const LABELS = ["triangle", "circle", "line", "follow me"];

for (const [name, label] of [
  ["unfinished-triangle.mp4", "triangle"],
  ["Circle2.mp4", "circle"],
  ["line-as-circle.mp4", "line"],
  ["airline.mp4", ""],
  ["follow_me.mp4", "follow me"],
  ["", ""],
]) {
  test(`the name "${name}" suggests "${label}"`, () => {
    assert.equal(labelInName(name, LABELS), label);
  });
}

test("of two labels that stand at the same place the longer one is suggested", () => {
  assert.equal(labelInName("follow-me-2.mp4", ["follow", "follow me"]), "follow me");
});
