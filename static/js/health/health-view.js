// The health view: the estimates of the health check, and the test with clips.

import * as api from "../core/api.js";
import { h, WRITES } from "../core/dom.js";
import { plural } from "../core/format.js";
import { currentLanguage, follow, state } from "../core/state.js";
import { attempt } from "../core/toasts.js";
import { go } from "../core/views.js";
import { batchSection } from "./clip-test-section.js";
import { confusionGrid } from "./confusion-grid.js";
import { dialSection } from "./dial.js";
import { compare } from "./finding-links.js";
import { findingsList } from "./findings-list.js";
import { estimateTable } from "./gesture-estimates.js";
import { cancel, check, isCurrent, keepChecked } from "./health-check.js";
import { languageMap, nearestOf } from "./language-map.js";
import { narrow } from "./narrowed-report.js";
import { predicted, showPair } from "./pair-page.js";
import { percent, rateText } from "./rates.js";

/** @import { HealthReport, State } from "../core/types.d.ts" */

/** @type {Record<string, string>} */
const STAGES = {
  rehearsing: "Simulating trials of every gesture",
  "accidental movements": "Simulating background motion",
  "turned divers": "Simulating turned divers",
  remedies: "Testing edits that would help",
};

/** @param {string} label */
const imageOf = (label) =>
  api.languages.image(
    state.health?.id ?? currentLanguage().id,
    label,
    state.health?.shown ?? currentLanguage().revision,
  );

/** @param {HealthReport} report */
function verdict({ ok, warnings: findings }) {
  const errors = findings.filter((finding) => finding.below_bar).length;
  const notes = findings.length - errors;
  const text = ok ? "No errors" : plural(errors, "error");
  return h(
    "p",
    { className: `verdict ${ok ? "well" : "unwell"}`, role: "status" },
    h("span", { className: "mark", "aria-hidden": "true" }, ok ? "\u2713" : "!"),
    h("b", {}, text),
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

/** @param {HealthReport} report */
function matrix(report) {
  const heads = report.gestures.map(({ label }) => ({ label, image: imageOf(label) }));
  /**
   * @param {number} row
   * @param {number} column
   */
  const cell = (row, column) => {
    const [one, other] = [report.gestures[row], report.gestures[column]];
    if (row === column) {
      const right = one.missed ? 1 - one.missed.rate : null;
      return {
        text: right === null ? "" : `${percent(right)}`,
        amount: 0,
        className: "diagonal",
        label:
          right === null
            ? `${one.label}: not known`
            : `${one.label} is read as itself in ${percent(right)} %`,
      };
    }
    const estimate = predicted(report, one.label, other.label)?.forth;
    const over = estimate && estimate.rate > report.bar.confusion;
    return {
      text: estimate ? percent(estimate.rate) : "?",
      amount: estimate?.rate ?? 0,
      className: over ? "over" : "",
      label: estimate
        ? `${one.label} taken for ${other.label}: ${rateText(estimate)}${over ? ", above the threshold" : ""}`
        : `${one.label} taken for ${other.label}: not known`,
      open: () => compare(one.label, other.label),
    };
  };
  return confusionGrid({
    label: "Estimated confusions, per cent",
    corner: "shown \u2193  taken for \u2192",
    rows: heads,
    columns: heads,
    cell,
  });
}

/**
 * Open the gesture of a thumbnail: beside the one that it is most often confused with, or alone if
 * it was compared with none.
 *
 * @param {HealthReport} report
 * @param {string} label
 */
function openNearest(report, label) {
  const other = nearestOf(report.pairs, label);
  if (other === null) go("gesture", { gesture: label });
  else compare(label, other);
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

/** @param {HealthReport} report */
function drawReport(report) {
  const alone = report.gestures.length === 1;
  const shown = narrow(report);
  const part =
    shown === report
      ? ""
      : ` The ${shown.gestures.length} most confused of ${report.gestures.length} gestures.`;
  const worst = shown.pairs.filter(
    ({ confusion }) => confusion && confusion.rate > report.bar.confusion,
  );
  const threshold = percent(report.bar.confusion);
  return [
    findingsList(report.warnings),
    alone
      ? h(
          "div",
          { className: "health-empty" },
          h("p", {}, h("b", {}, "One gesture by itself is confused with nothing")),
          h(
            "p",
            { className: "dim" },
            "Add a second gesture to see here how often the two are confused.",
          ),
        )
      : h(
          "div",
          { className: "health-columns" },
          section(
            "Estimated confusions",
            `Per cent of simulated trials of the gesture on the left that are nearest to the gesture above. Framed: above the threshold of ${threshold} %. Choose a cell to compare the two.${part}`,
            matrix(shown),
          ),
          section(
            "Map",
            `Similar gestures are close to each other.${worst.length ? ` Joined: pairs above the threshold of ${threshold} %.` : ""}${part}`,
            languageMap({
              points: shown.map,
              worst,
              imageOf,
              open: (label) => openNearest(report, label),
            }),
          ),
        ),
    section(
      "Each gesture",
      `Missed: recognised as another gesture, or rejected. The threshold is ${percent(report.bar.missed)} %. False alarms: background motion, such as reaching or adjusting the mask, that is recognised as the gesture.`,
      estimateTable(report, imageOf),
    ),
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
      "Save a gesture from a clip. From the second gesture on, this page estimates which are confused, before the dive.",
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
 * The rates of a trigger as a further sentence; empty for salutes and without a trigger.
 *
 * @param {HealthReport} report
 */
function triggerText({ trigger }) {
  if (!trigger) return "";
  const { missed, false_per_hour: often } = trigger;
  return `. The trigger is missed in ${percent(missed.rate)} of trials, and set off ${Math.round(often)} times in an hour of moving arms`;
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
    about.textContent = report
      ? `Revision ${health?.shown}, estimated for another diver by ${report.takes} simulated trials of each gesture${triggerText(report)}`
      : "";
    says.replaceChildren(
      ...(report && isCurrent(health) && health?.status === "done" ? [verdict(report)] : []),
    );
    bar.replaceChildren(
      ...[gestures?.gestures.length ? progress(state) : null].filter((each) => each !== null),
    );
    advance(bar, state);
  };
  /** @type {HealthReport | "nothing" | null} */
  let drawn = null;
  const draw = () => {
    const { gestures, health, loaded } = state;
    const report = reportOf(state);
    const now = gestures?.gestures.length ? report : "nothing";
    body.classList.toggle("stale", Boolean(report) && health?.status !== "done");
    if (now === drawn || (now === "nothing" && !loaded)) return;
    drawn = now;
    body.replaceChildren(...(now === "nothing" ? [nothing()] : report ? drawReport(report) : []));
  };
  follow(["gestures", "health"], head);
  follow(["checking"], () => advance(bar, state));
  follow(["gestures", "health", "loaded"], draw);
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
      /** @type {HTMLElement | null} */ (all.querySelector("td[tabindex='0']"))?.focus();
  });
}
