import assert from "node:assert/strict";
import { test } from "node:test";

import {
  csvOf,
  intervalOf,
  ratesOf,
  testedOf,
} from "../../../static/js/health/clip-test-results.js";

const CLIPS = [
  { id: "a", name: "circle-2.mp4" },
  { id: "b", name: "circle-10.mp4" },
];

const recognition = (clip_id, values) => ({
  clip_id,
  start: 0,
  end: 1,
  expected: "circle",
  label: "circle",
  nearest: "circle",
  confidence: 0.9,
  profile: "full",
  tuning: null,
  revision: 3,
  id: `r-${clip_id}`,
  ...values,
});

test("only the newest recognition of a take counts, sorted as people count", () => {
  const tested = testedOf(
    [recognition("b", { label: null }), recognition("b", {}), recognition("a", {})],
    CLIPS,
    "full",
  );
  assert.deepEqual(
    tested.map(({ clip, right }) => [clip, right]),
    [
      ["circle-2.mp4", true],
      ["circle-10.mp4", false],
    ],
  );
});

test("what was not expected, tuned, by another profile or of a deleted clip does not count", () => {
  const others = [
    recognition("a", { expected: null }),
    recognition("a", { start: 2, tuning: { weights: {} } }),
    recognition("a", { start: 4, profile: "paper" }),
    recognition("a", { start: 6, trial: { label: "circle", change: {} } }),
    recognition("gone", {}),
  ];
  assert.deepEqual(testedOf(others, CLIPS, "full"), []);
});

test("a spreadsheet neither calculates a name nor splits it", () => {
  const [heads, row] = csvOf([
    { ...recognition("a", {}), clip: '=1+1, "x".mp4', right: true },
  ]).split("\r\n");
  assert.equal(heads, "clip,start,end,expected,label,nearest,confidence,right,revision,id");
  assert.equal(row, `"'=1+1, ""x"".mp4",0,1,circle,circle,circle,0.9,true,3,r-a`);
});

test("a take that is a demonstration is marked", () => {
  const gestures = [{ source: { clip_id: "a", start: 0, end: 1.2 } }, { source: null }];
  const takes = testedOf(
    [recognition("a", {}), recognition("a", { start: 5, end: 6 })],
    CLIPS,
    "full",
    gestures,
  );
  assert.deepEqual(
    takes.map(({ demonstration }) => demonstration),
    [true, false],
  );
});

test("rates have Wilson's interval, the lowest rate first", () => {
  const { low, high } = intervalOf(9, 10);
  assert.ok(Math.abs(low - 0.596) < 0.001 && Math.abs(high - 0.982) < 0.001);
  const takes = [true, true, false].map((right, index) => ({
    expected: index ? "line" : "circle",
    right,
  }));
  assert.deepEqual(
    ratesOf(takes).map(({ label, right, count }) => [label, right, count]),
    [
      ["line", 1, 2],
      ["circle", 1, 1],
    ],
  );
});
