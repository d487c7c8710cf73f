// What to expect of a language: its test set first, then what its demonstrations foretell.

import { h, WRITES } from "../core/dom.js";
import { plural } from "../core/format.js";
import { follow } from "../core/state.js";
import { runTestSet } from "../languages/test-set.js";
import { invitationsPart } from "./invitations.js";
import { curvePart } from "./people-curve.js";
import { rateText } from "./rates.js";

/** @import { HealthReport, TestSet } from "../core/types.d.ts" */

const ENOUGH_PEOPLE = 3; // From which on a forecast is promised.

/**
 * What the test set has measured; empty without recognised takes.
 *
 * @param {TestSet | null} testSet
 */
export function testWords(testSet) {
  if (!testSet?.overall.asked) return "";
  const { right, asked, rate, low, high } = testSet.overall;
  const share =
    rate === null || low === null || high === null ? "" : `, ${rateText({ rate, low, high })}`;
  const older = testSet.waiting
    ? ` Not by revision ${testSet.revision}: ${plural(testSet.waiting, "take")}.`
    : "";
  return `Of the test set ${right} of ${asked} takes are read right${share}.${older}`;
}

/**
 * The gestures of which the test set reads less than half right, as words; empty: none.
 *
 * @param {TestSet | null} testSet
 */
export function failingWords(testSet) {
  const failing = (testSet?.gestures ?? []).filter(
    ({ right, asked }) => asked > 1 && 2 * right < asked,
  );
  return failing.map(({ label, right, asked }) => `${label} ${right} of ${asked}`).join(", ");
}

/**
 * What the language's own demonstrations foretell, a sentence each.
 *
 * @param {HealthReport["forecast"]} forecast
 */
export function forecastWords({ people, words, asks_more: more, right, asked, refused, wrong }) {
  if (!right || !asked || !refused || !wrong) return [words];
  const others = [
    `${rateText(asked)} are asked back with the right gesture`,
    `${rateText(refused)} refused`,
    `${rateText(wrong)} read as another`,
  ];
  return [
    `Of ${right.n} demonstrations ${rateText(right)} are read right by those of other people.`,
    `${others.join(", ")}.`,
    people < ENOUGH_PEOPLE
      ? "Two people are few: ask a third to show the language."
      : more
        ? "The last person raised the lower end by two points or more: ask one more."
        : "The last person raised the lower end by less than two points: more people would help little.",
  ];
}

/**
 * The button that recognises the takes again that an older revision has read; null without any.
 *
 * @param {TestSet | null} testSet
 */
const againButton = (testSet) =>
  testSet?.waiting && testSet.overall.asked
    ? h(
        "button",
        { type: "button", className: "link", ...WRITES, onclick: () => runTestSet() },
        "Recognise again",
      )
    : null;

/** Make the section, and keep it in step with the report and the test set. */
export function expectation() {
  const lines = h("div", { className: "expectation-lines", role: "status" });
  const section = h(
    "section",
    { className: "health-section expectation", "aria-labelledby": "expect-title", hidden: true },
    h("h2", { id: "expect-title" }, "What to expect"),
    lines,
    curvePart(),
    invitationsPart(),
  );
  let drawn = "";
  follow(["gestures", "health", "testSet"], ({ gestures, health, testSet }) => {
    const report = gestures && health?.id === gestures.id ? health.report : null;
    const measured = testWords(testSet?.language_id === gestures?.id ? testSet : null);
    const words = [
      ...(measured ? [measured] : []),
      ...(report?.gestures.length ? forecastWords(report.forecast) : []),
    ];
    section.hidden = !words.length;
    lines.classList.toggle("stale", Boolean(report) && health?.status !== "done");
    if (words.join() === drawn) return; // A status that is written again is read out again.
    drawn = words.join();
    lines.replaceChildren(
      ...words.map((each, index) =>
        h("p", { className: index ? "" : "first" }, each, index ? null : againButton(testSet)),
      ),
    );
  });
  return section;
}
