import assert from "node:assert/strict";
import { test } from "node:test";

import {
  heldName,
  listWarnings,
  salutesIn,
  saluteWarning,
  takesLanguage,
} from "../../../static/js/clips/salutes.js";

// 0.6 s of salute, 2 s of stroke, 0.6 s of salute, and one frame by chance.
const RATE = 20;
const SALUTE = [
  ...Array(12).fill(0.9),
  ...Array(40).fill(0.1),
  ...Array(12).fill(0.8),
  ...Array(5).fill(0),
  0.9,
];
const TIMELINE = { time: SALUTE.map((_, frame) => frame / RATE), salute: SALUTE };

test("the salutes in a range are those of which it contains more than an edge", () => {
  assert.equal(salutesIn(TIMELINE, 0, 3.5).length, 2);
  assert.deepEqual(salutesIn(TIMELINE, 0, 1), [[0, 0.55]]);
  assert.deepEqual(salutesIn(TIMELINE, 0.55, 2.6), []);
  assert.deepEqual(salutesIn(TIMELINE, 3.2, 3.5), []);
});

test("only a range with salutes is warned of", () => {
  assert.equal(saluteWarning([]), "");
  const bare = /** @type {any} */ ({ id: "c", trigger: { kind: "none" } });
  assert.equal(heldName(bare), "gesture");
  assert.match(saluteWarning([[0, 1]]), /contains 1 Vulcan salute,/);
});

test("a language with an arm trigger gets no warning about salutes", () => {
  const clip = /** @type {any} */ ({ warnings: ["dark"], salute_warnings: ["no salute"] });
  const posed = /** @type {any} */ ({ id: "a", trigger: { kind: "pose" } });
  const saluting = /** @type {any} */ ({ id: "b", trigger: null });
  assert.deepEqual(listWarnings(clip, posed), ["dark"]);
  assert.deepEqual(listWarnings(clip, saluting), ["dark", "no salute"]);
  assert.deepEqual(listWarnings(clip, null), ["dark", "no salute"]);
});

test("a language with an arm trigger is asked for takes by its own name of what is held", () => {
  const posed = /** @type {any} */ ({ id: "a", trigger: { kind: "pose" } });
  const saluting = /** @type {any} */ ({ id: "b", trigger: null });
  assert.deepEqual(
    [takesLanguage(posed), takesLanguage(saluting), takesLanguage(null)],
    ["a", null, null],
  );
  assert.deepEqual([heldName(posed), heldName(saluting)], ["arm pose", "Vulcan salute"]);
  assert.match(
    saluteWarning(
      [
        [0, 1],
        [2, 3],
      ],
      heldName(posed),
    ),
    /2 arm poses.*between the poses/,
  );
});
