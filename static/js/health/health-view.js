// The health view: what to expect of a language, the findings of its check, and its test set.

import * as api from "../core/api.js";
import { h, WRITES } from "../core/dom.js";
import { plural } from "../core/format.js";
import { currentLanguage, follow, state } from "../core/state.js";
import { attempt } from "../core/toasts.js";
import { go } from "../core/views.js";
import { batchSection } from "./test-set-section.js";
import { dialSection } from "./dial.js";
import { expectation, failingWords } from "./expectation.js";
import { compare } from "./finding-links.js";
import { findingsList } from "./findings-list.js";
import { gestureTable } from "./gesture-table.js";
import { cancel, check, isCurrent, keepChecked } from "./health-check.js";
import { languageMap, narrow } from "./language-map.js";
import { showPair } from "./pair-page.js";
import { percent } from "./rates.js";

/** @import { HealthReport, State, TestSet } from "../core/types.d.ts" */

/** @type {Record<string, string>} */
const STAGES = {
  "other people's demonstrations": "Reading demonstrations by those of other people",
  "numbers of people": "Reading by fewer and by more people",
  distances: "Comparing the gestures",
  "turned divers": "Turning the divers",
  "known signs": "Comparing with divers\u2019 signs",
};

/** @param {string} label */
const imageOf = (label) =>
  api.languages.image(
    state.health?.id ?? currentLanguage().id,
    label,
    state.health?.shown ?? currentLanguage().revision,
  );

/**
 * The check in a few words: its errors, and the gestures that the test set shows to fail.
 *
 * @param {HealthReport} report
 * @param {TestSet | null} testSet
 */
function verdict({ ok, warnings: findings }, testSet) {
  const errors = findings.filter((finding) => finding.error).length;
  const notes = findings.length - errors;
  const failing = failingWords(testSet);
  const well = ok && !failing;
  return h(
    "p",
    { className: `verdict ${well ? "well" : "unwell"}`, role: "status" },
    h("span", { className: "mark", "aria-hidden": "true" }, well ? "\u2713" : "!"),
    errors || !failing ? h("b", {}, ok ? "No errors" : plural(errors, "error")) : null,
    failing ? h("b", { title: "Of the test set read right" }, failing) : null,
    notes ? h("span", { className: "dim" }, plural(notes, "note")) : null,
  );
}

/**
 * The bar above the report while a check runs, and after it was cancelled or failed.
 *
 * @param {State} state
 */
function progress({ health }) {
  if (!health || !isCurrent(health) || health.status === "done") return null;
  const again = h(
    "button",
    { type: "button", className: "primary", onclick: check },
    "Check again",
  );
  if (health.status === "cancelled")
    return h(
      "div",
      { className: "checking" },
      h(
        "p",
        {},
        h("b", {}, "The check was cancelled."),
        " What is shown below, if anything, is of an older revision.",
      ),
      again,
    );
  if (health.status === "failed")
    return h(
      "div",
      { className: "checking", role: "alert" },
      h("p", {}, h("b", {}, "The check failed. "), health.error),
      again,
    );
  return h(
    "div",
    { className: "checking" },
    h(
      "p",
      {},
      h("b", {}, `Checking revision ${health.revision}`),
      h("span", { className: "dim num" }, "Beginning"),
    ),
    h("progress", { "aria-label": "Progress of the check" }),
    h(
      "button",
      { type: "button", ...WRITES, onclick: () => attempt("Cancelling", cancel) },
      "Cancel",
    ),
  );
}

/**
 * Show the progress of the check in place, so that its button stays under the pointer.
 *
 * @param {HTMLElement} bar
 * @param {State} state
 */
function advance(bar, { health, checking }) {
  const running = bar.querySelector("progress");
  if (!running || !checking || checking.id !== health?.id || checking.revision !== health.revision)
    return;
  const { stage, done, total } = checking;
  bar
    .querySelector(".num")
    ?.replaceChildren(
      `${STAGES[stage] ?? stage}, ${total ? `${done} of ${total}` : `${done} so far`}`,
    );
  if (total) Object.assign(running, { max: total, value: done });
  else running.removeAttribute("value");
}

/**
 * Open the gesture of a thumbnail: beside the nearest one, or alone if none is comparable.
 *
 * @param {HealthReport} report
 * @param {string} label
 */
function openNearest(report, label) {
  const other = report.gestures.find((gesture) => gesture.label === label)?.nearest;
  if (other) compare(label, other.label);
  else go("gesture", { gesture: label });
}

/**
 * @param {string} title
 * @param {string} hint
 * @param {...Node} content
 */
const section = (title, hint, ...content) =>
  h(
    "section",
    { className: "health-section" },
    h("div", { className: "section-head" }, h("h2", {}, title), h("p", { className: "dim" }, hint)),
    ...content,
  );

/**
 * @param {HealthReport} report
 * @param {TestSet | null} testSet
 */
function drawReport(report, testSet) {
  const shown = narrow(report);
  const all = report.gestures.length;
  const part = shown.length < all ? ` The ${shown.length} nearest of ${all} gestures.` : "";
  const same = report.warnings
    .filter(({ kind, gestures }) => kind === "duplicate" && gestures.length === 2)
    .map(({ gestures }) => gestures);
  return [
    findingsList(report.warnings),
    section(
      "Each gesture",
      "Takes that are read right come first, where there are any. Nearest gesture: the fused distance of the two demonstrations, 1 for two typical gestures. A far gesture may still be misread.",
      gestureTable(report, testSet, imageOf),
    ),
    all > 1
      ? section(
          "Map",
          `Similar gestures are close to each other.${same.length ? " Joined: gestures that cannot be told apart." : ""}${part}`,
          languageMap({
            points: shown,
            same,
            imageOf,
            open: (label) => openNearest(report, label),
          }),
        )
      : null,
  ].filter((each) => each !== null);
}

function nothing() {
  return h(
    "div",
    { className: "health-empty" },
    h("p", {}, h("b", {}, state.gestures ? "No gestures to check yet" : "No language yet")),
    h(
      "p",
      { className: "dim" },
      "Save a gesture from a clip. Shown by three people, its language tells here what others will reach, before the dive.",
    ),
    h(
      "button",
      { type: "button", className: "primary", onclick: () => go("studio") },
      "To the clips",
    ),
  );
}

/**
 * The report of the language on display, possibly of an older revision.
 *
 * @param {State} state
 */
const reportOf = ({ gestures, health }) =>
  health && health.id === gestures?.id ? health.report : null;

/**
 * The test set of the language on display.
 *
 * @param {State} state
 */
const testSetOf = ({ gestures, testSet }) =>
  testSet && testSet.language_id === gestures?.id ? testSet : null;

/**
 * The rates of a trigger as a further sentence; empty for salutes and without a trigger.
 *
 * @param {HealthReport} report
 */
function triggerText({ trigger }) {
  if (!trigger) return "";
  const { missed, false_per_hour: often } = trigger;
  return `. The trigger is missed of ${percent(missed.rate)} % of simulated people, and set off ${Math.round(often)} times in an hour of moving arms`;
}

/** Go to the test with clips, which stands below the report. */
function showTest() {
  const title = document.getElementById("test-title");
  title?.scrollIntoView({ block: "start" });
  title?.focus({ preventScroll: true });
}

function overview() {
  const name = h("h1");
  const about = h("small", { className: "dim" });
  const says = h("div", { className: "verdict-place" });
  const bar = h("div");
  const body = h("div", { className: "report" });
  const head = () => {
    const { gestures, health } = state;
    const report = reportOf(state);
    name.textContent = gestures ? `Health of ${gestures.name}` : "Health";
    about.textContent = report ? `Revision ${health?.shown}${triggerText(report)}` : "";
    says.replaceChildren(
      ...(report && isCurrent(health) && health?.status === "done"
        ? [verdict(report, testSetOf(state))]
        : []),
    );
    bar.replaceChildren(
      ...[gestures?.gestures.length ? progress(state) : null].filter((each) => each !== null),
    );
    advance(bar, state);
  };
  /** @type {HealthReport | "nothing" | null} */
  let drawn = null;
  let tested = "";
  const draw = () => {
    const { gestures, health, loaded } = state;
    const report = reportOf(state);
    const testSet = testSetOf(state);
    const now = gestures?.gestures.length ? report : "nothing";
    const tests = JSON.stringify(testSet?.gestures ?? []);
    body.classList.toggle("stale", Boolean(report) && health?.status !== "done");
    if ((now === drawn && tests === tested) || (now === "nothing" && !loaded)) return;
    drawn = now;
    tested = tests;
    body.replaceChildren(
      ...(now === "nothing" ? [nothing()] : report ? drawReport(report, testSet) : []),
    );
  };
  follow(["gestures", "health", "testSet"], head);
  follow(["checking"], () => advance(bar, state));
  follow(["gestures", "health", "loaded", "testSet"], draw);
  return h(
    "div",
    { className: "health-page" },
    h(
      "div",
      { className: "health-head" },
      h("div", {}, name, about),
      says,
      h("button", { type: "button", onclick: showTest }, "Test with clips"),
    ),
    bar,
    expectation(),
    body,
    dialSection(),
    batchSection(),
  );
}

/**
 * Build the view.
 *
 * @param {HTMLElement} root
 */
export function open(root) {
  const all = overview();
  const two = h("div", { className: "health-page pair-page", hidden: true });
  root.append(all, two);
  /** @type {string | null} */
  let shown = null;
  follow(["view", "gestures", "returns"], keepChecked);
  follow(["pair", "gestures"], ({ pair, gestures }) => {
    const opens = pair !== null && gestures !== null;
    all.hidden = opens;
    two.hidden = !opens;
    const now = opens ? `${pair} ${gestures.id} ${gestures.revision}` : null;
    if (now === shown) return;
    const before = shown;
    shown = now;
    if (opens) showPair(two, imageOf);
    else if (before)
      /** @type {HTMLElement | null} */ (all.querySelector(".nearest button"))?.focus();
  });
}
