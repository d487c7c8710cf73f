// The health line of the cards: requested when a card becomes visible, one after another, since the
// first report on a revision takes the server seconds.

import * as api from "../core/api.js";
import { plural } from "../core/format.js";
import { state } from "../core/state.js";
import { html, nothing } from "../templates.js";

/** @import { HealthReport, LanguageSummary } from "../core/types.d.ts" */

/** @type {Map<string, HealthReport | null>} */
const reports = new Map(); // by language and revision; null: there is none
/** @type {Set<string>} */
const seen = new Set(); // languages whose cards are on display
let offered = true; // false once the server turned out to have no such report
let asking = false;
let draw = () => {};

/** @param {LanguageSummary} language */
const keyOf = ({ id, revision }) => `${id} ${revision}`;

/**
 * The line of a card: the findings in words and as a mark.
 *
 * @param {LanguageSummary} language
 */
export function healthLine(language) {
  const report = reports.get(keyOf(language));
  if (!report) {
    const pending = language.labels.length && offered && report === undefined;
    return pending ? html`<p class="health pending">Health is being checked</p>` : nothing;
  }
  const { ok, warnings: findings } = report;
  const errors = findings.filter((finding) => finding.error);
  const notes = findings.length ? `No errors, ${plural(findings.length, "note")}` : "No errors";
  const title = findings.map(({ message }) => message).join("\n");
  return html`<p class="health ${ok ? "well" : "unwell"}" title=${title}>
    ${errors.length ? `${plural(errors.length, "health error")}: ${errors[0].message}` : notes}
  </p>`;
}

/** Request the report of a card on display that has none, and then the next. */
async function next() {
  // Scrolling past a hundred cards must not request a hundred reports.
  const language = state.languages.find(
    (each) => seen.has(each.id) && each.labels.length && !reports.has(keyOf(each)),
  );
  if (asking || !language || !offered) return;
  asking = true;
  try {
    reports.set(keyOf(language), await api.languages.check(language.id, language.revision));
  } catch (error) {
    // A card may stay without a report; a deleted language's card is about to disappear.
    reports.set(keyOf(language), null);
    if (error.status === 404) offered = false;
  }
  asking = false;
  draw();
  next();
}

const watch = new IntersectionObserver((entries) => {
  for (const { isIntersecting, target } of entries) {
    const { language = "" } = /** @type {HTMLElement} */ (target).dataset;
    if (isIntersecting) seen.add(language);
    else seen.delete(language);
  }
  next();
});

/**
 * Request the reports of the cards that are seen; `react` is called with each.
 *
 * @param {Iterable<Element>} cards
 * @param {() => void} react
 */
export function watchCards(cards, react) {
  draw = react;
  for (const card of cards) watch.observe(card);
  next();
}
