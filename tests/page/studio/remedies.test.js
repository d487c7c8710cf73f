import assert from "node:assert/strict";
import { test } from "node:test";

import { lessonOf, offeredOf } from "../../../static/js/studio/remedies.js";

const found = (kind, values = {}, lost = []) => ({
  change: { kind, words: kind, ...values },
  label: "square",
  confidence: 1,
  effect: kind === "trim" ? null : { takes: 8, right_before: 8, right_after: 8, lost },
});
const RESULT = { start: 2, end: 4 };
const kindsOf = (...counterfactuals) =>
  offeredOf({ counterfactuals }, RESULT).map(({ change }) => change.kind);

test("what teaches most comes first, weights and a replaced demonstration last", () => {
  assert.deepEqual(
    kindsOf(
      found("demonstration"),
      found("voter_weight"),
      found("trim", { start: 2.1, end: 4 }),
      found("switch"),
      found("further_demonstration"),
    ),
    ["further_demonstration", "switch", "trim", "voter_weight", "demonstration"],
  );
});

test("what breaks another gesture is not offered", () => {
  assert.deepEqual(kindsOf(found("demonstration", {}, ["triangle"]), found("switch")), ["switch"]);
});

test("a trim that keeps less than four fifths of the stroke is not offered", () => {
  assert.deepEqual(kindsOf(found("trim", { start: 3.43, end: 3.77 })), []);
  assert.deepEqual(kindsOf(found("trim", { start: 2.3, end: 4.2 })), ["trim"]);
});

test("what to show differently is the difference that explains most", () => {
  const differences = [
    { share: 0, words: "it is slower", start: null },
    { share: 0.6, words: "the third side is missing", start: 3.1 },
  ];
  assert.deepEqual(lessonOf({ differences }), { words: "the third side is missing", start: 3.1 });
  assert.equal(lessonOf({ differences: [] }), null);
});
