import assert from "node:assert/strict";
import { test } from "node:test";

import { forecastWords, testWords } from "../../../static/js/health/expectation.js";
import { testedShare } from "../../../static/js/health/gesture-table.js";

const rate = (value) => ({ rate: value, low: value / 2, high: (1 + value) / 2, n: 12 });
const share = {
  label: "circle",
  right: 3,
  asked: 4,
  untestable: 0,
  rate: 0.75,
  low: 0.3,
  high: 0.95,
};

const measured = {
  people: 3,
  words: "",
  asks_more: false,
  right: rate(0.75),
  asked: rate(0.1),
  refused: rate(0.1),
  wrong: rate(0.05),
};

test("what is measured among people is told with every outcome", () => {
  assert.deepEqual(forecastWords(measured), [
    "Of 12 demonstrations 75 % (38 to 88) are read right by those of other people.",
    "10 % (5 to 55) are asked back with the right gesture, 10 % (5 to 55) refused, 5 % (2 to 52) read as another.",
    "The last person raised the lower end by less than two points: more people would help little.",
  ]);
});

test("another person is asked for while the last one raised the lower end", () => {
  assert.match(forecastWords({ ...measured, asks_more: true }).at(-1), /ask one more/);
});

test("two people are said to be few", () => {
  assert.match(forecastWords({ ...measured, people: 2, asks_more: true }).at(-1), /ask a third/);
});

test("where nothing can be foretold there are no outcomes", () => {
  const words = "One person has shown this language.";
  assert.deepEqual(forecastWords({ ...measured, words, right: null }), [words]);
});

test("a test set is told with its interval, and not before it has a recognised take", () => {
  assert.equal(testWords(null), "");
  assert.equal(
    testWords({ overall: { right: 0, asked: 0, rate: null, low: null, high: null } }),
    "",
  );
  assert.equal(
    testWords({ overall: share, takes: [] }),
    "Of the test set 3 of 4 takes are read right, 75 % (30 to 95).",
  );
});

test("a take that cannot be tested stays in the figure, which has no rate then", () => {
  assert.equal(
    testWords({ overall: { ...share, untestable: 2 }, takes: [] }),
    "Of the test set 3 of 6 takes are read right, 2 cannot be tested.",
  );
});

test("a gesture has the share of its own takes in the test set", () => {
  const testSet = { gestures: [share] };
  assert.deepEqual(testedShare(testSet, "circle"), { rate: 0.75, low: 0.3, high: 0.95, n: 4 });
  assert.equal(testedShare(testSet, "line"), null);
  assert.equal(testedShare(null, "circle"), null);
});

test("a figure of an older revision says so, and so does one of a part of the takes", () => {
  const waiting = (takes) => testWords({ overall: share, waiting: 4, revision: 22, takes });
  assert.match(waiting([]), /Not by revision 22: 4 takes\.$/);
  const unread = { testable: true, result: null };
  const lone = { testable: false, result: null };
  const words = waiting([unread, unread, unread, lone]);
  assert.match(words, / Not read yet: 3 takes\. Not by revision 22: 1 take\.$/);
});
