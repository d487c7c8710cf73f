import assert from "node:assert/strict";
import { test } from "node:test";

import {
  free,
  gesturePart,
  inPart,
  inPhrase,
  moved,
  slotsOf,
  typed,
  withPhrase,
  withSlot,
  withSlotRenamed,
  withSlotTypeRenamed,
} from "../../../static/js/phrases/grammar-edits.js";

const EMPTY = {
  start: null,
  end: null,
  cancel: null,
  timeout: 10,
  most_phrases: 1,
  slot_types: [],
  phrases: [],
};
const LABELS = ["stop", "up", "one"];

test("a new phrase shows a gesture that nothing uses yet", () => {
  const grammar = withPhrase({ ...EMPTY, start: "stop" }, "ascend", LABELS);
  assert.deepEqual(grammar.phrases[0].parts, [{ gestures: ["up"], least: 1, most: 1 }]);
  assert.deepEqual(gesturePart({ ...grammar, cancel: "stop" }, ["stop", "up"]).gestures, ["up"]);
});

test("a new slot brings its values where there are none, and a name of its own", () => {
  const one = withSlot(withPhrase(EMPTY, "ascend", LABELS), "ascend", [], LABELS);
  const two = withSlot(one, "ascend", [], LABELS);
  assert.equal(two.slot_types.length, 1);
  assert.deepEqual(
    slotsOf(two.phrases[0]).map(({ slot }) => slot),
    ["number", "number_2"],
  );
});

test("a slot is renamed also in the texts and the command that refer to it", () => {
  const phrase = {
    name: "ascend",
    says: "up {number} m",
    command: { go: ["{number}", 1] },
    parts: [
      {
        parts: [{ slot: "number", type: "number", least: 1, most: 1, default: null }],
        least: 1,
        most: 1,
      },
    ],
  };
  const renamed = withSlotRenamed(phrase, "number", "metres");
  assert.equal(renamed.says, "up {metres} m");
  assert.deepEqual(renamed.command, { go: ["{metres}", 1] });
  assert.deepEqual(
    slotsOf(renamed).map(({ slot }) => slot),
    ["metres"],
  );
});

test("a slot type is renamed where slots refer to it", () => {
  const grammar = withSlot(withPhrase(EMPTY, "ascend", LABELS), "ascend", [], LABELS);
  const renamed = withSlotTypeRenamed(grammar, "number", "digit");
  assert.equal(renamed.slot_types[0].name, "digit");
  assert.deepEqual(
    slotsOf(renamed.phrases[0]).map(({ type }) => type),
    ["digit"],
  );
});

test("a part inside a group is changed and nothing else", () => {
  const group = {
    parts: [gesturePart(EMPTY, ["up"]), gesturePart(EMPTY, ["one"])],
    least: 0,
    most: 1,
  };
  const grammar = {
    ...EMPTY,
    phrases: [
      { name: "a", parts: [group] },
      { name: "b", parts: [group] },
    ],
  };
  const change = inPhrase(
    "a",
    inPart([0, 1], (part) => ({ ...part, most: 3 })),
  );
  const { phrases } = change(grammar);
  assert.deepEqual(
    phrases[0].parts[0].parts.map(({ most }) => most),
    [1, 3],
  );
  assert.equal(phrases[1], grammar.phrases[1]);
});

test("neighbours change places; names that are taken get a number", () => {
  assert.deepEqual(moved(["a", "b", "c"], 2, -1), ["a", "c", "b"]);
  assert.equal(free("phrase", ["phrase", "phrase 2"]), "phrase 3");
  assert.equal(free("phrase", []), "phrase");
});

test("a value is a number where the slot type reads numbers, with either decimal sign", () => {
  assert.deepEqual(
    [typed(" 1,5 ", "number"), typed("7", "text"), typed("deep", "number"), typed("", "digits")],
    [1.5, "7", "deep", ""],
  );
});
