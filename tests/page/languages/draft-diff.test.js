import assert from "node:assert/strict";
import { test } from "node:test";

import { changedTexts, diffGestures } from "../../../static/js/languages/draft-diff.js";

const gesture = (label, values = {}) => ({
  label,
  description: "",
  command: null,
  thumbnail: `/t/${label}`,
  ...values,
});

const FROM = {
  name: "pool",
  author: "",
  gestures: [gesture("circle"), gesture("line"), gesture("up")],
};

test("gestures are the same, changed, added or removed", () => {
  const mine = {
    ...FROM,
    gestures: [gesture("circle"), gesture("line", { command: "go" }), gesture("new")],
  };
  assert.deepEqual(
    diffGestures(mine, FROM).map(({ gesture: { label }, kind }) => [label, kind]),
    [
      ["circle", "same"],
      ["line", "changed"],
      ["new", "added"],
      ["up", "removed"],
    ],
  );
});

test("a gesture that is renamed is changed, and its new label is listed", () => {
  const mine = {
    ...FROM,
    gestures: [gesture("ring", { thumbnail: "/t/circle" }), ...FROM.gestures.slice(1)],
  };
  assert.equal(diffGestures(mine, FROM)[0].kind, "changed");
  assert.deepEqual(changedTexts({ ...mine, name: "lake" }, FROM), [
    "name: “lake”",
    "label: “ring”",
  ]);
});
