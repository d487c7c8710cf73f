// A recognition of a demonstration tests the language on itself.

import assert from "node:assert/strict";
import { test } from "node:test";

import { demonstratedBy } from "../../../static/js/clips/demonstration-ranges.js";

const circle = {
  label: "circle",
  demonstrations: [{ source: null }, { source: { clip_id: "a", start: 1, end: 3 } }],
};

test("a range that shares most of a demonstration is its demonstration", () => {
  assert.equal(demonstratedBy([circle], { clip_id: "a", start: 0.5, end: 3.5 }), "circle");
  assert.equal(demonstratedBy([circle], { clip_id: "a", start: 1.5, end: 3 }), "circle");
});

test("another clip, another range and a clip without takes are none", () => {
  assert.equal(demonstratedBy([circle], { clip_id: "b", start: 1, end: 3 }), null);
  assert.equal(demonstratedBy([circle], { clip_id: "a", start: 2.5, end: 6 }), null);
  assert.equal(demonstratedBy([circle], { clip_id: "a", start: null, end: null }), null);
});
