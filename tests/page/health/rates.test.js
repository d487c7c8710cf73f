import assert from "node:assert/strict";
import { test } from "node:test";

import { costWords, effectText, percent, rateText } from "../../../static/js/health/rates.js";

test("a half is rounded to the even number, as in the findings' own words", () => {
  assert.deepEqual([0.005, 0.015, 0.025, 0.125, 0.135].map(percent), ["<1", "2", "2", "12", "14"]);
});

test("every fortieth is rounded as Python's formats of per cents do", () => {
  const python =
    "0 2 5 8 10 12 15 18 20 22 25 28 30 32 35 38 40 42 45 48 50 " +
    "52 55 57 60 62 65 68 70 72 75 78 80 82 85 88 90 92 95 98 100";
  const rates = Array.from({ length: 41 }, (_, takes) => takes / 40);
  assert.equal(rates.map(percent).join(" "), python);
});

test("a rate above 0 is never written as 0", () => {
  assert.deepEqual([0, 0.001, 1].map(percent), ["0", "<1", "100"]);
});

test("an interval whose ends read the same is left out", () => {
  assert.equal(rateText({ rate: 0.001, low: 0.0005, high: 0.004 }), "<1 %");
  assert.equal(rateText({ rate: 0.2, low: 0.13, high: 0.26 }), "20 % (13 to 26)");
});

const LIMIT = {
  people: 3,
  most_refused: 0.05,
  limit: 0.6,
  measured: true,
  refused: { n: 24, rate: 0.042, low: 0.01, high: 0.2 },
  accepted: { n: 24, rate: 0.5, low: 0.31, high: 0.69 },
};

test("both costs of the limit are a sentence each, of at most fifteen words", () => {
  const words = costWords(LIMIT);
  assert.deepEqual(words, [
    "Of 24 right takes by other people, 4 % (1 to 20) are refused.",
    "Of 24 takes of missing gestures, 50 % (31 to 69) are accepted.",
  ]);
  for (const each of words) assert.ok(each.split(" ").length <= 15, each);
});

test("where one person has shown the gestures, the page asks for two more", () => {
  const alone = { ...LIMIT, people: 1, measured: false, refused: null, accepted: null };
  assert.deepEqual(costWords(alone), [
    "One person has shown this language. The limit is a cautious constant: ask two more people.",
  ]);
});

test("a limit that too few demonstrations measure is called a constant beside its costs", () => {
  const [why, refused, ...more] = costWords({ ...LIMIT, measured: false, accepted: null });
  assert.match(why, /cautious constant/);
  assert.match(refused, /are refused/);
  assert.deepEqual(more, []);
});

test("the effect of another movement is told by distances, and names the pairs that stay alike", () => {
  const nearest = { gestures: ["up", "down"], words: "told apart, distance 1.20" };
  const words = "Nearest is down: told apart, distance 1.20.";
  assert.equal(effectText({ nearest, alike: [] }), words);
  const alike = [{ gestures: ["up", "stop"], words: "nearly alike" }];
  assert.equal(effectText({ nearest, alike }), `${words} Nearly alike: up and stop.`);
});
