import assert from "node:assert/strict";
import { test } from "node:test";

import {
  candidatesOf,
  choiceOf,
  furtherNote,
  labelIfNew,
  labelOf,
  problemsOf,
  rangeText,
  rangeWarning,
  rowsOf,
  withoutGesture,
} from "../../../static/js/gestures/gesture-rows.js";

const clip = (id, name, status = "done") => ({ id, name, status, duration: 4 });
const TAKE = { start: 0.5, end: 3, stroke_start: 1, stroke_end: 2.5, closed: true };

test("a file name proposes a label, a camera's number proposes none", () => {
  const proposed = {
    "circle-demonstration.mp4": "circle",
    "follow_me-test-2.MOV": "follow me",
    "up.mp4": "up",
    "IMG_2043.mp4": "",
    "GX010123.MP4": "",
    "2026-11-22 10.14.33.mp4": "",
    "на верх 3.mkv": "на верх",
  };
  for (const [name, label] of Object.entries(proposed)) assert.equal(labelOf(name), label, name);
});

test("every take is a row, and clips without poses wait", () => {
  const takes = new Map([
    ["a", [TAKE]],
    ["b", [TAKE, TAKE]],
    ["c", []],
  ]);
  const clips = [
    clip("a", "circle.mp4"),
    clip("b", "square.mp4"),
    clip("c", "line.mp4"),
    clip("d", "wave.mp4", "running"),
  ];
  const rows = rowsOf(clips, takes, null, new Map());
  assert.deepEqual(
    rows.map(({ label }) => label),
    ["circle", "square 1", "square 2", "line", "wave"],
  );
  assert.deepEqual(rows.map(rangeText), [
    "1.00 s to 2.50 s",
    "take 1 of 2, 1.00 s to 2.50 s",
    "take 2 of 2, 1.00 s to 2.50 s",
    "the whole clip, 4.00 s",
    "",
  ]);
  assert.match(rangeWarning(rows[3]), /^No Vulcan salute was found/);
  assert.match(problemsOf(rows).note, /^1 clip still without poses/);
  const loading = rowsOf(clips.slice(0, 3), new Map(), null, new Map());
  assert.match(problemsOf(loading).note, /^Takes of 3 clips not loaded yet/);
});

test("a range that is a demonstration already is not proposed again", () => {
  const source = { clip_id: "a", start: 1, end: 2 };
  const language = { gestures: [{ label: "ring", demonstrations: [{ source }, {}] }] };
  const at = (clip, start, end) => ({ clip_id: clip, start, end });
  assert.equal(labelIfNew("ring", language, at("a", 0.5, 1.5)), "");
  assert.equal(labelIfNew("ring", language, at("a", 2, 3)), "ring");
  assert.equal(labelIfNew("ring", language, at("b", 1, 2)), "ring");
  assert.equal(labelIfNew("line", language, at("a", 1, 2)), "line");
});

test("clips of the language and second clips of a label are left out until they are chosen", () => {
  const takes = new Map(["a", "b", "c"].map((id) => [id, [TAKE]]));
  const clips = [clip("a", "circle.mp4"), clip("b", "square-1.mp4"), clip("c", "square-2.mp4")];
  const language = {
    labels: ["ring"],
    gestures: [{ label: "ring", demonstrations: [{ source: { clip_id: "a" } }] }],
  };
  const chosen = (edited) =>
    rowsOf(clips, takes, language, new Map(edited)).map((row) => row.chosen);
  assert.deepEqual(chosen([]), [false, true, false]);
  assert.deepEqual(chosen([["c", { chosen: true }]]), [false, true, true]);
  assert.deepEqual(chosen([["b", { chosen: false }]]), [false, false, false]);
  assert.deepEqual(chosen([["b", { label: "box" }]]), [false, true, false]);
});

test("a take of the test set that shows none of the gestures gets its name from the clip", () => {
  const takes = new Map([["a", [TAKE]]]);
  const readings = new Map([["a 0", { label: null, expected: "-" }]]);
  const [row] = rowsOf([clip("a", "wave.mp4")], takes, null, new Map(), readings);
  assert.deepEqual([row.label, row.chosen], ["wave", false]);
});

test("a take without an end is left out until it is chosen", () => {
  const open = new Map([["a", [{ ...TAKE, closed: false }]]]);
  const chosen = (edited) =>
    rowsOf([clip("a", "circle.mp4")], open, null, new Map(edited)).map((row) => row.chosen);
  assert.deepEqual(chosen([]), [false]);
  assert.deepEqual(chosen([["a", { chosen: true }]]), [true]);
});

test("a row needs a name that no other row has, unless the language has the gesture", () => {
  const row = (key, label, further = "") => ({
    key,
    label,
    further,
    chosen: true,
    takes: [TAKE],
    take: TAKE,
  });
  const { problems, note } = problemsOf([row("a", "up"), row("b", " up"), row("c", "")]);
  assert.deepEqual([...problems.keys()], ["b", "c"]);
  assert.match(note, /^2 rows without a name/);
  assert.equal(problemsOf([row("a", "up")]).note, "");
  assert.equal(problemsOf([row("a", "up", "up"), row("b", "up", "up")]).note, "");
});

test("takes of gestures of the language are further demonstrations, unless they are read", () => {
  const clips = [
    clip("a", "line t2.mp4"),
    clip("b", "IMG_1.mp4"),
    clip("c", "line t3.mp4"),
    clip("d", "می\u200cروم.mp4"),
    clip("e", "wave t1.mp4"),
  ];
  const takes = new Map(clips.map(({ id }) => [id, [TAKE]]));
  const language = { labels: ["line", "circle", "میروم"], gestures: [] };
  const readings = new Map([
    ["a 0", { label: "line", expected: null }],
    ["b 0", { label: "line", expected: "circle" }],
    ["d 0", { label: null, expected: null }],
  ]);
  const rows = rowsOf(clips, takes, language, new Map(), readings);
  assert.deepEqual(
    rows.map(({ label, further, chosen, right }) => [label, further, chosen, right]),
    [
      ["line", "line", false, true],
      ["circle", "circle", false, false], // a take of the test set
      ["line", "line", false, false], // not read yet
      ["میروم", "میروم", true, false],
      ["wave", "", true, false],
    ],
  );
  assert.match(furtherNote(rows[0]), /further demonstration of “line”.*read as “line” already/);
  assert.match(furtherNote(rows[3]), /demonstration of “میروم”\.$/);
  assert.equal(furtherNote(rows[2]), "");
  assert.equal(furtherNote(rows[4]), "");
});

test("a clip shows no gesture yet unless a demonstration of the language was taken of it", () => {
  const language = { gestures: [{ demonstrations: [{ source: { clip_id: "a" } }, {}] }] };
  const clips = [clip("a", "circle.mp4"), clip("b", "square.mp4", "running")];
  assert.deepEqual(withoutGesture(clips, language), [clips[1]]);
  assert.deepEqual(withoutGesture(clips, null), clips);
});

test("a choice leaves rows out and says why, until the user selects them again", () => {
  const clips = [clip("a", "box.mp4"), clip("b", "square.mp4"), clip("c", "line.mp4")];
  const takes = new Map(clips.map(({ id }) => [id, [TAKE]]));
  const before = rowsOf(clips, takes, null, new Map([["c", { chosen: false }]]));
  const among = candidatesOf(before);
  assert.deepEqual(
    among.map(({ key }) => key),
    ["a", "b"],
  );
  const left = { index: 1, other: "box", words: "nearly alike, distance 0.12" };
  const edited = choiceOf(among, { keep: [0], left_out: [left], people: "" });
  const after = rowsOf(clips, takes, null, edited);
  assert.deepEqual(
    after.map(({ chosen }) => chosen),
    [true, false, true],
  );
  assert.equal(after[1].why, "Left out; nearest is \u201cbox\u201d: nearly alike, distance 0.12.");
  assert.equal(candidatesOf(after).length, 3);
  edited.set("b", { ...edited.get("b"), chosen: true });
  assert.equal(rowsOf(clips, takes, null, edited)[1].why, "");
});

test("neither waiting rows nor further demonstrations are chosen among", () => {
  const clips = [clip("a", "circle.mp4"), clip("b", "box.mp4"), clip("c", "line.mp4")];
  const takes = new Map([
    ["a", [TAKE]],
    ["b", [TAKE]],
  ]);
  const language = { labels: ["circle"], gestures: [] };
  const edited = new Map([["a", { chosen: true }]]);
  const among = candidatesOf(rowsOf(clips, takes, language, edited));
  assert.deepEqual(
    among.map(({ key }) => key),
    ["b"],
  );
});
