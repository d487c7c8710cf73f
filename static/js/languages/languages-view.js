// The library: every language as a card, or the history of one.

import { h } from "../core/dom.js";
import { plural } from "../core/format.js";
import { follow, state } from "../core/state.js";
import { html, iconOf, nothing, render, repeat } from "../templates.js";
import { watchCards } from "./card-health.js";
import { card } from "./language-card.js";
import { importLanguage, newLanguage } from "./language-store.js";
import { openHistoryPanel } from "./revision-history.js";
import { loadSampleLanguages, sampleLanguages } from "./sample-languages.js";

/** @import { LanguageSummary } from "../core/types.d.ts" */

const REDRAWN_EVERY = 60000; // ms. "2 minutes ago" grows old.

let search = "";

/** @param {{ target: any }} event */
async function importFiles({ target }) {
  for (const file of [...target.files]) await importLanguage(file);
  target.value = "";
}

const importButton = () =>
  html`<span class="import"
    ><input
      type="file"
      id="language-file"
      multiple
      accept=".json,application/json"
      class="visually-hidden"
      data-writes
      @change=${importFiles}
    /><label for="language-file" class="button" data-writes>Import a file…</label></span
  >`;

/**
 * Whether a language's name, author or labels contain the words of a search.
 *
 * @param {LanguageSummary} language
 * @param {string[]} words
 */
function answers({ name, author, labels }, words) {
  const text = [name, author, ...labels].join(" ").toLowerCase();
  return words.every((word) => text.includes(word));
}

/** The note where no card is shown. */
const empty = () =>
  state.languages.length
    ? html`<p>No language is called “${search}” or has such a gesture.</p>`
    : html`<p><b>No languages yet</b></p>
        <p class="dim">
          A language is a set of gestures that one robot understands. Make an empty one, drop a
          language file (.json), or begin with a sample.
        </p>`;

/** @param {() => void} draw */
function library(draw) {
  const { languages, loaded } = state;
  const words = search.toLowerCase().split(/\s+/).filter(Boolean);
  const shown = languages
    .filter((language) => answers(language, words))
    .sort((one, other) => other.updated.localeCompare(one.updated));
  const all = plural(languages.length, "language");
  const find = (/** @type {any} */ { target }) => {
    search = target.value;
    draw();
  };
  return html`<div class="page-head">
      <h1>Languages</h1>
      <small class="dim" role="status" ?hidden=${!languages.length}
        >${words.length ? `${shown.length} of ${all}` : all}</small
      >
      <span class="spacer"></span>
      <input
        type="search"
        placeholder="Name or gesture"
        aria-label="Find languages"
        autocomplete="off"
        ?hidden=${languages.length < 2}
        @input=${find}
      />
      ${importButton()}
      <button type="button" class="primary" data-writes @click=${() => newLanguage()}>
        ${iconOf("plus")}New language
      </button>
    </div>
    <ul class="languages-grid" aria-label="Languages">
      ${repeat(shown, ({ id }) => id, card)}
    </ul>
    ${loaded && !shown.length ? html`<div class="languages-empty">${empty()}</div>` : nothing}${sampleLanguages()}`;
}

/**
 * Build the view.
 *
 * @param {HTMLElement} section
 */
export function open(section) {
  const cards = h("div", { className: "library-page" });
  const past = h("div", { className: "history-page", hidden: true });
  section.append(cards, past);
  const draw = () => {
    render(library(draw), cards);
    watchCards(cards.querySelectorAll(".language"), draw);
  };
  follow(["languages", "language", "loaded"], draw);
  follow(["languages", "loaded"], async ({ loaded }) => {
    if (loaded) await loadSampleLanguages();
    draw();
  });
  setInterval(draw, REDRAWN_EVERY);
  openHistoryPanel(past);
  follow(["panel", "language"], ({ panel, language }) => {
    const shows = panel === "history" && language !== null;
    cards.hidden = shows;
    past.hidden = !shows;
  });
}
