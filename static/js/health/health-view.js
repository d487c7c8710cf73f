// The health view: what to expect of a language, the findings of its check, and its test set.

import * as api from "../core/api.js";
import { h } from "../core/dom.js";
import { plural } from "../core/format.js";
import { currentLanguage, follow, state } from "../core/state.js";
import { guard, html, nothing, progressBar, render } from "../templates.js";
import { attempt } from "../core/toasts.js";
import { go } from "../core/views.js";
import { takeFilesIn } from "../upload/upload-list.js";
import { dialSection } from "./dial.js";
import { expectation } from "./expectation.js";
import { compare } from "./finding-links.js";
import { findingsList } from "./findings-list.js";
import { gestureTable } from "./gesture-table.js";
import { cancel, check, isCurrent, judgeAgain, keepChecked } from "./health-check.js";
import { loadInvitations } from "./invitations.js";
import { languageMap, narrow } from "./language-map.js";
import { showPair } from "./pair-page.js";
import { percent } from "./rates.js";
import { addTestClips, workOff } from "./test-set-clips.js";
import { batchSection } from "./test-set-section.js";

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
 * What the check and the test set say of the language, in a few words.
 *
 * @param {HealthReport} report
 */
function verdict({ warnings: findings, verdict: { ready, words, errors } }) {
  const notes = findings.length - errors;
  return html`<p class="verdict ${ready ? "well" : "unwell"}" role="status">
    <span class="mark" aria-hidden="true">${ready ? "\u2713" : "!"}</span><b>${words}</b>${
      notes ? html`<span class="dim">${plural(notes, "note")}</span>` : nothing
    }
  </p>`;
}

/**
 * How far the check of the revision on display is, in words and as a share if that is known.
 *
 * @param {State} state
 */
function advanceOf({ health, checking }) {
  if (!checking || checking.id !== health?.id || checking.revision !== health.revision)
    return { words: "Beginning" };
  const { stage, done, total } = checking;
  const words = `${STAGES[stage] ?? stage}, ${total ? `${done} of ${total}` : `${done} so far`}`;
  return total ? { words, total, done } : { words };
}

/**
 * The bar above the report while a check runs, and after it was cancelled or failed.
 *
 * @param {State} state
 */
function progress(state) {
  const { health, gestures } = state;
  if (!gestures?.gestures.length || !health || !isCurrent(health) || health.status === "done")
    return nothing;
  const again = html`<button type="button" class="primary" @click=${check}>Check again</button>`;
  if (health.status === "cancelled")
    return html`<div class="checking">
      <p>
        <b>The check was cancelled.</b> What is shown below, if anything, is of an older revision.
      </p>
      ${again}
    </div>`;
  if (health.status === "failed")
    return html`<div class="checking" role="alert">
      <p><b>The check failed. </b>${health.error}</p>
      ${again}
    </div>`;
  const { words, total, done } = advanceOf(state);
  return html`<div class="checking">
    <p><b>Checking revision ${health.revision}</b><span class="dim num">${words}</span></p>
    ${progressBar("Progress of the check", done, total)}
    <button type="button" data-writes @click=${() => attempt("Cancelling", cancel)}>Cancel</button>
  </div>`;
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
 * @param {unknown} content
 */
const section = (title, hint, content) =>
  html`<section class="health-section">
    <div class="section-head">
      <h2>${title}</h2>
      <p class="dim">${hint}</p>
    </div>
    ${content}
  </section>`;

/**
 * @param {HealthReport} report
 * @param {TestSet | null} testSet
 */
function drawReport(report, testSet) {
  return [
    findingsList(report.warnings),
    section(
      "Each gesture",
      "Takes that are read right come first, where there are any. Nearest gesture: the fused distance of the two demonstrations, 1 for two typical gestures. A far gesture may still be misread.",
      gestureTable(report, testSet, imageOf),
    ),
  ];
}

/**
 * All gestures by their distances; nothing of a single one.
 *
 * @param {HealthReport} report
 */
function drawMap(report) {
  const shown = narrow(report);
  const all = report.gestures.length;
  const part = shown.length < all ? ` The ${shown.length} nearest of ${all} gestures.` : "";
  const same = report.warnings
    .filter(({ kind, gestures }) => kind === "duplicate" && gestures.length === 2)
    .map(({ gestures }) => gestures);
  return all > 1
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
    : nothing;
}

const empty = () =>
  html`<div class="health-empty">
    <p><b>${state.gestures ? "No gestures to check yet" : "No language yet"}</b></p>
    <p class="dim">
      Save a gesture from a clip. Shown by three people, its language tells here what others will
      reach, before the dive.
    </p>
    <button type="button" class="primary" @click=${() => go("studio")}>To the clips</button>
  </div>`;

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

/**
 * @param {State} state
 * @param {HealthReport | null} report
 */
function head({ gestures, health }, report) {
  const says = report && isCurrent(health) && health?.status === "done";
  return html`<div class="health-head">
    <div>
      <h1>${gestures ? `Health of ${gestures.name}` : "Health"}</h1>
      <small class="dim">${report && `Revision ${health?.shown}${triggerText(report)}`}</small>
    </div>
    <div class="verdict-place">${says ? verdict(report) : nothing}</div>
    <button type="button" @click=${showTest}>Test with clips</button>
  </div>`;
}

/**
 * All of the view, as the state has it.
 *
 * @param {State} state
 */
function overview(state) {
  const { gestures, health, loaded, unfolded } = state;
  const report = reportOf(state);
  const testSet = testSetOf(state);
  const stale = report && health?.status !== "done" ? "stale" : "";
  const parts = () => (report ? drawReport(report, testSet) : nothing);
  const body = gestures?.gestures.length
    ? guard([report, testSet, gestures, unfolded], parts)
    : loaded && empty();
  return html`${head(state, report)}
    <div>${progress(state)}</div>
    ${expectation(state, report, testSet)}
    <div class="report ${stale}">${body || nothing}</div>
    ${batchSection(testSet)}
    <div class="report ${stale}">
      ${guard([report, gestures], () => (report?.gestures.length ? drawMap(report) : nothing))}
    </div>
    ${dialSection(state, report)}`;
}

/**
 * Draw the view; what has the focus stays where it is when a report comes above it.
 *
 * @param {State} state
 * @param {HTMLElement} root
 * @param {HTMLElement} all
 */
function draw(state, root, all) {
  const { activeElement: focused } = document;
  const top = () => (all.contains(focused) ? (focused?.getBoundingClientRect().top ?? 0) : 0);
  const before = top();
  const held = before > 0 && before < innerHeight;
  root.style.overflowAnchor = held ? "none" : ""; // The browser holds what is topmost.
  render(overview(state), all);
  if (held) root.scrollBy(0, top() - before);
}

/** @type {any} */
const ALL = Object.keys(state); // A name that is left out here would be a part that goes stale.

/**
 * Build the view.
 *
 * @param {HTMLElement} root
 */
export function open(root) {
  const all = h("div", { className: "health-page" });
  const two = h("div", { className: "health-page pair-page", hidden: true });
  root.append(all, two);
  /** @type {string | null} */
  let shown = null;
  takeFilesIn("health", addTestClips);
  follow(["pending", "clips", "gestures"], workOff);
  follow(["view", "gestures", "returns"], keepChecked);
  follow(["testSet"], judgeAgain);
  follow(["view", "gestures", "clips", "health"], loadInvitations);
  let pressed = false; // Until it is released, nothing moves: else the click would miss.
  const show = () => state.view === "health" && !pressed && draw(state, root, all);
  all.addEventListener("pointerdown", ({ button, target }) => {
    // The list of a select may take the release.
    pressed = button === 0 && !(/** @type {HTMLElement} */ (target).closest("select"));
  });
  const release = () => {
    pressed = false;
    show();
  };
  for (const end of ["pointerup", "pointercancel", "blur"])
    addEventListener(end, () => pressed && setTimeout(release)); // after the click
  follow(ALL, show);
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
