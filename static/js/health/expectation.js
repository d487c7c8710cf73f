// What to expect of a language: its test set first, then what its demonstrations foretell.

import { plural } from "../core/format.js";
import { html, nothing } from "../templates.js";
import { runTestSet } from "../languages/test-set.js";
import { invitationsPart } from "./invitations.js";
import { curvePart } from "./people-curve.js";
import { rateText, testedText } from "./rates.js";

/** @import { HealthReport, State, TestSet } from "../core/types.d.ts" */

const ENOUGH_PEOPLE = 3; // From which on a forecast is promised.

/**
 * What the test set has measured; empty without recognised takes.
 *
 * @param {TestSet | null} testSet
 */
export function testWords(testSet) {
  if (!testSet?.overall.asked) return "";
  const { right, asked, untestable } = testSet.overall;
  const unread = testSet.takes.filter(({ testable, result }) => testable && !result).length;
  const older = testSet.waiting - unread;
  const notes = [
    unread ? ` Not read yet: ${plural(unread, "take")}.` : "",
    older ? ` Not by revision ${testSet.revision}: ${plural(older, "take")}.` : "",
  ].join("");
  const all = asked + untestable;
  return `Of the test set ${right} of ${all} takes are read right${testedText(testSet.overall)}.${notes}`;
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
 * The button that recognises the takes again that an older revision has read.
 *
 * @param {TestSet | null} testSet
 */
const againButton = (testSet) =>
  testSet?.waiting && testSet.overall.asked
    ? html`<button type="button" class="link" data-writes @click=${() => runTestSet()}>
        Recognise again
      </button>`
    : nothing;

/**
 * The section, as the report and the test set have it.
 *
 * @param {State} state
 * @param {HealthReport | null} report
 * @param {TestSet | null} testSet
 */
export function expectation(state, report, testSet) {
  const measured = testWords(testSet);
  const words = [
    ...(measured ? [measured] : []),
    ...(report?.gestures.length ? forecastWords(report.forecast) : []),
  ];
  const stale = state.health?.status === "done" ? "" : "stale";
  return html`<section
    class="health-section expectation"
    aria-labelledby="expect-title"
    ?hidden=${!words.length}
  >
    <h2 id="expect-title">What to expect</h2>
    <div class="expectation-lines ${report && stale}" role="status">
      ${words.map(
        (each, index) =>
          html`<p class=${index ? "" : "first"}>
            ${each}${index ? nothing : againButton(testSet)}
          </p>`,
      )}
    </div>
    ${curvePart(report?.forecast.curve ?? [], stale)}${invitationsPart(state, report)}
  </section>`;
}
