import assert from "node:assert/strict";
import { test } from "node:test";

import {
  nearnessOf,
  orderOf,
  shortNumber,
  splitByWeight,
} from "../../../static/js/studio/vote-order.js";

const RESULT = {
  profile: "paper",
  scores: [1, 2, 3],
  voters: ["hu", "path", "tempo"],
  gestures: ["line", "circle", "square"],
  distances: [
    [0.1, 0.2, 0.3],
    [3, 1, 2],
    [null, 1, 1],
  ],
  votes: { hu: "line", path: "circle", tempo: "circle" },
  weights: { hu: 0.2, path: 0.8, tempo: 0 },
};

test("voters stand by weight, gestures by the weight of their voters and then by nearness", () => {
  assert.deepEqual(orderOf(RESULT), { rows: [1, 0, 2], columns: [1, 0, 2] });
});

test("where distance decides, the nearest gesture stands first whatever the votes", () => {
  const scores = [1.2, null, 0.7];
  assert.deepEqual(orderOf({ ...RESULT, profile: "full", scores }).columns, [2, 0, 1]);
  assert.deepEqual(orderOf({ ...RESULT, profile: "full", scores: [] }).columns, [1, 0, 2]);
});

test("nearness is relative to the voter's own distances", () => {
  assert.deepEqual(nearnessOf([3, 1, 2, null]), [0, 1, 0.5, 0]);
  assert.deepEqual(nearnessOf([0.4, 0.4]), [1, 1]);
});

test("a distance takes four characters", () => {
  const texts = [0, 0.0531, 0.53, 5.3, 53, 530, 5.3e9, null].map(shortNumber);
  assert.deepEqual(texts, ["0", ".053", ".53", "5.30", "53.0", "530", "5e+9", "\u221e"]);
});

test("voters without weight stand apart, unless a person took their weight", () => {
  assert.deepEqual(splitByWeight(RESULT, [1, 0, 2], {}), { heard: [1, 0], silent: [2] });
  assert.deepEqual(splitByWeight(RESULT, [1, 0, 2], { tempo: 0 }).silent, []);
});
