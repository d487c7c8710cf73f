// The health line of the cards: requested when a card becomes visible, one after another, since the
// first report on a revision takes the server seconds.

import * as api from "../core/api.js";
import { follow, state } from "../core/state.js";
import { html, nothing } from "../templates.js";

/** @import { HealthReport, LanguageSummary } from "../core/types.d.ts" */

/** @type {Map<string, HealthReport | null>} */
const reports = new Map(); // by language and revision; null: there is none
/** @type {Set<string>} */
const seen = new Set(); // languages whose cards are on display
let offered = true; // false once the server turned out to have no such report
let asking = ""; // the key of the report that is requested
let outdated = false; // whether a test has changed the verdict since
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
  const { verdict, warnings: findings } = report;
  const first = findings.find((finding) => finding.error);
  const title = findings.map(({ message }) => message).join("\n");
  return html`<p class="health ${verdict.ready ? "well" : "unwell"}" title=${title}>
    ${verdict.words}${first && `: ${first.message}`}
  </p>`;
}

/** Request the report of a card on display that has none, and then the next. */
async function next() {
  // Scrolling past a hundred cards must not request a hundred reports.
  const language = state.languages.find(
    (each) => seen.has(each.id) && each.labels.length && !reports.has(keyOf(each)),
  );
  if (asking || !language || !offered) return;
  asking = keyOf(language);
  outdated = false;
  try {
    const report = await api.languages.check(language.id, language.revision);
    if (!outdated) reports.set(keyOf(language), report);
  } catch (error) {
    // A card may stay without a report; a deleted language's card is about to disappear.
    reports.set(keyOf(language), null);
    if (error.status === 404) offered = false;
  }
  asking = "";
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

// A test of the language changes the verdict on it.
follow(["labelled"], ({ labelled }) => {
  if (!labelled) return;
  const isOf = (/** @type {string} */ key) => key.startsWith(`${labelled.id} `);
  outdated ||= isOf(asking);
  for (const key of reports.keys()) if (isOf(key)) reports.delete(key);
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
