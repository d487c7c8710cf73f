// The library: every language as a card, or the history of one.

import { h, icon, reconcile, WRITES } from "../core/dom.js";
import { plural } from "../core/format.js";
import { follow, state } from "../core/state.js";
import { drawCard } from "./language-card.js";
import { importLanguage, newLanguage } from "./language-store.js";
import { openHistoryPanel } from "./revision-history.js";
import { drawSampleLanguages } from "./sample-languages.js";

/** @import { LanguageSummary } from "../core/types.d.ts" */

const REDRAWN_EVERY = 60000; // ms. "2 minutes ago" grows old.

function importButton() {
  const input = h("input", {
    type: "file",
    id: "language-file",
    multiple: true,
    accept: ".json,application/json",
    className: "visually-hidden",
    ...WRITES,
  });
  input.onchange = async () => {
    for (const file of [...(input.files ?? [])]) await importLanguage(file);
    input.value = "";
  };
  return h(
    "span",
    { className: "import" },
    input,
    h("label", { for: "language-file", className: "button", ...WRITES }, "Import a file\u2026"),
  );
}

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

function library() {
  const search = h("input", {
    type: "search",
    placeholder: "Name or gesture",
    "aria-label": "Find languages",
    autocomplete: "off",
  });
  const count = h("small", { className: "dim", role: "status" });
  const cards = h("ul", { className: "languages-grid", "aria-label": "Languages" });
  const empty = h("div", { className: "languages-empty", hidden: true });
  const samples = h("section", {
    className: "samples-offer",
    "aria-label": "Sample languages",
    hidden: true,
  });
  const draw = () => {
    const { languages, loaded } = state;
    const words = search.value.toLowerCase().split(/\s+/).filter(Boolean);
    const shown = languages
      .filter((language) => answers(language, words))
      .sort((one, other) => other.updated.localeCompare(one.updated));
    count.textContent = words.length
      ? `${shown.length} of ${plural(languages.length, "language")}`
      : plural(languages.length, "language");
    count.hidden = !languages.length;
    search.hidden = languages.length < 2;
    empty.hidden = !loaded || shown.length > 0;
    empty.replaceChildren(
      ...(languages.length
        ? [h("p", {}, `No language is called \u201c${search.value}\u201d or has such a gesture.`)]
        : [
            h("p", {}, h("b", {}, "No languages yet")),
            h(
              "p",
              { className: "dim" },
              "A language is a set of gestures that one robot understands. Make an empty one, drop a language file (.json), or begin with a sample.",
            ),
          ]),
    );
    reconcile(cards, shown, (language) => language.id, drawCard);
  };
  search.oninput = draw;
  follow(["languages", "language", "loaded"], draw);
  follow(["languages", "loaded"], ({ loaded }) => {
    if (loaded) drawSampleLanguages(samples);
  });
  setInterval(draw, REDRAWN_EVERY);
  return h(
    "div",
    { className: "library-page" },
    h(
      "div",
      { className: "page-head" },
      h("h1", {}, "Languages"),
      count,
      h("span", { className: "spacer" }),
      search,
      importButton(),
      h(
        "button",
        { type: "button", className: "primary", ...WRITES, onclick: () => newLanguage() },
        icon("plus"),
        "New language",
      ),
    ),
    cards,
    empty,
    samples,
  );
}

/**
 * Build the view.
 *
 * @param {HTMLElement} section
 */
export function open(section) {
  const cards = library();
  const past = h("div", { className: "history-page", hidden: true });
  section.append(cards, past);
  openHistoryPanel(past);
  follow(["panel", "language"], ({ panel, language }) => {
    const shows = panel === "history" && language !== null;
    cards.hidden = shows;
    past.hidden = !shows;
  });
}
