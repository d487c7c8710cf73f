// The health line of the cards: requested when a card becomes visible, one after another, since the
// first report on a revision takes the server seconds.

import * as api from "../core/api.js";

/** @import { HealthReport, LanguageSummary } from "../core/types.d.ts" */

/** @type {Map<string, HealthReport>} */
const reports = new Map(); // by language and revision
/** @type {{ card: Element, language: LanguageSummary, line: HTMLElement }[]} */
const waiting = [];
/** @type {WeakMap<Element, LanguageSummary>} */
const languageOf = new WeakMap(); // by card
let offered = true; // false once the server turned out to have no such report
let asking = false;

/** @param {LanguageSummary} language */
const keyOf = ({ id, revision }) => `${id} ${revision}`;

/**
 * Show that the report is pending.
 *
 * @param {HTMLElement} line
 */
function promise(line) {
  line.hidden = false;
  line.className = "health pending";
  line.textContent = "Health is being checked";
  line.removeAttribute("title");
}

/**
 * The line under a card: the findings in words and as a mark.
 *
 * @param {HTMLElement} line
 * @param {HealthReport | undefined} report
 */
function write(line, report) {
  if (!report) return;
  const { verdict, warnings: findings } = report;
  line.hidden = false;
  line.className = `health ${verdict.ready ? "well" : "unwell"}`;
  const first = findings.find((finding) => finding.error);
  line.textContent = verdict.words + (first ? `: ${first.message}` : "");
  line.title = findings.map((finding) => finding.message).join("\n");
}

async function next() {
  const first = waiting.shift();
  if (!first || !offered) return;
  const { language, line } = first;
  asking = true;
  try {
    if (line.isConnected && !reports.has(keyOf(language)))
      reports.set(keyOf(language), await api.languages.check(language.id, language.revision));
    write(line, reports.get(keyOf(language)));
  } catch (error) {
    // A card may stay without a report; a deleted language's card is about to disappear.
    line.hidden = true;
    if (error.status === 404) offered = false;
  }
  asking = false;
  next();
}

const seen = new IntersectionObserver((entries) => {
  for (const { isIntersecting, target } of entries) {
    const line = /** @type {HTMLElement | null} */ (target.querySelector(".health"));
    const at = waiting.findIndex((each) => each.card === target);
    // Scrolling past a hundred cards must not request a hundred reports.
    if (at >= 0) waiting.splice(at, 1);
    const language = languageOf.get(target);
    if (isIntersecting && line && language) waiting.push({ card: target, language, line });
  }
  if (!asking) next();
});

/**
 * Fill a card's line once the card is seen.
 *
 * @param {HTMLElement} card
 * @param {LanguageSummary} language
 */
export function showHealth(card, language) {
  const line = /** @type {HTMLElement} */ (card.querySelector(".health"));
  line.hidden = true;
  seen.unobserve(card);
  if (reports.has(keyOf(language))) return write(line, reports.get(keyOf(language)));
  if (!language.labels.length || !offered) return undefined;
  promise(line);
  languageOf.set(card, language);
  return seen.observe(card);
}
