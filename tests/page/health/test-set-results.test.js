import assert from "node:assert/strict";
import { test } from "node:test";

import { csvOf, testedOf } from "../../../static/js/health/test-set-results.js";
import { NONE } from "../../../static/js/languages/test-set.js";

const take = (id, clip, result, values = {}) => ({
  id,
  clip_id: `c-${id}`,
  clip,
  start: 0,
  end: 1,
  expected: "circle",
  demonstration: false,
  result: result && {
    revision: 3,
    recognition_id: `r-${id}`,
    label: "circle",
    nearest: "circle",
    confidence: 0.9,
    right: true,
    fault: null,
    pair: null,
    ...result,
  },
  before: null,
  ...values,
});

test("takes are sorted as people count, and say what got better and worse", () => {
  const takes = [
    take("b", "circle-10.mp4", { label: null, right: false }),
    take("a", "circle-2.mp4", {}),
    take("c", "circle-11.mp4", null),
  ];
  const tested = testedOf({ takes, better: ["a"], worse: ["b"] });
  assert.deepEqual(
    tested.map(({ clip, known, right, change }) => [clip, known, right, change]),
    [
      ["circle-2.mp4", true, true, "better"],
      ["circle-10.mp4", true, false, "worse"],
      ["circle-11.mp4", false, false, null],
    ],
  );
  assert.deepEqual(testedOf(null), []);
});

test("a take that was asked back has both gestures in the table", () => {
  const takes = [
    take("a", "a.mp4", { label: null, right: false, pair: ["circle", "ring"] }),
    take("b", "b.mp4", null),
  ];
  const tested = testedOf({ takes, better: [], worse: [] });
  assert.deepEqual(
    tested.map(({ pair }) => pair),
    [["circle", "ring"], null],
  );
  assert.match(csvOf(tested).split("\r\n")[1], /,a,circle or ring$/);
});

test("a spreadsheet neither calculates a name nor splits it", () => {
  const takes = [take("a", '=1+1, "x".mp4', {})];
  const [heads, row] = csvOf(testedOf({ takes, better: [], worse: [] })).split("\r\n");
  assert.equal(heads, "clip,start,end,expected,label,nearest,confidence,right,revision,id,pair");
  assert.equal(row, `"'=1+1, ""x"".mp4",0,1,circle,circle,circle,0.9,true,3,a,`);
});

test("a take that shows none of the gestures has a dash in the file", () => {
  const takes = [take("a", "a.mp4", { label: null }, { expected: null, expected_none: true })];
  const tested = testedOf({ takes, better: [], worse: [] });
  assert.equal(tested[0].expected, NONE);
  assert.match(csvOf(tested).split("\r\n")[1], /^a\.mp4,0,1,-,,circle/);
});
