// The card of a language in the library.

import * as api from "../core/api.js";
import { h } from "../core/dom.js";
import { ago, dateAndTime, plural } from "../core/format.js";
import { menu } from "../core/menu.js";
import { state } from "../core/state.js";
import { address, go, here } from "../core/views.js";
import { showHealth } from "./card-health.js";
import { duplicate, openHistory, remove, rename } from "./language-actions.js";
import { choose } from "./language-store.js";

/** @import { LanguageSummary } from "../core/types.d.ts" */

const PICTURES = 5; // One row of a card; the others are only counted.

/** @param {LanguageSummary} language */
function pictures({ id, revision, labels }) {
  if (!labels.length) return h("p", { className: "no-gestures dim" }, "No gestures yet");
  const shown = labels.slice(0, labels.length > PICTURES ? PICTURES - 1 : PICTURES);
  const more = labels.length - shown.length;
  return h(
    "ul",
    { className: "thumbnails", "aria-label": "Gestures" },
    shown.map((label) =>
      h(
        "li",
        {},
        h("img", {
          src: api.languages.image(id, label, revision),
          alt: label,
          title: label,
          loading: "lazy",
          width: 64,
          height: 64,
        }),
      ),
    ),
    more
      ? h("li", { className: "rest", title: labels.slice(shown.length).join(", ") }, `+${more}`)
      : null,
  );
}

/**
 * @param {LanguageSummary} language
 * @param {"studio" | "health"} [view]
 */
async function work(language, view = "studio") {
  await choose(language.id);
  go(view);
}

/** @param {LanguageSummary} language */
function commands(language) {
  return menu(`What to do with ${language.name}`, [
    { text: "Rename\u2026", run: () => rename(language), writes: true },
    { text: "Duplicate", run: () => duplicate(language), writes: true },
    { text: "History", run: () => openHistory(language) },
    { text: "Invite people", run: () => work(language, "health"), writes: true },
    { text: "Export", href: api.languages.exportUrl(language.id, "osg-studio") },
    { text: "Delete", run: () => remove(language), writes: true },
  ]);
}

/**
 * Draw a card, or keep the existing one if nothing has changed.
 *
 * @param {LanguageSummary} language
 * @param {HTMLElement} [element]
 */
export function drawCard(language, element) {
  const current = language.id === state.language;
  const signature = JSON.stringify([language, current, ago(language.updated)]);
  if (element?.dataset.signature === signature) return element;
  const focused = element?.contains(document.activeElement)
    ? document.activeElement?.className
    : null;
  const card = element ?? h("li", { className: "language" });
  card.dataset.signature = signature;
  card.classList.toggle("current", current);
  card.replaceChildren(
    h(
      "div",
      { className: "language-head" },
      h(
        "h2",
        {},
        h(
          "a",
          {
            href: address("studio", {
              language: language.id,
              recognition: null,
              panel: null,
              older: null,
              newer: null,
            }),
            className: "language-name",
            "aria-current": current ? "true" : null,
            onclick: here(() => work(language)),
          },
          language.name,
        ),
      ),
      current ? h("span", { className: "tag chosen" }, "in use") : null,
      language.sample ? h("span", { className: "tag" }, "sample") : null,
      commands(language),
    ),
    pictures(language),
    h(
      "p",
      { className: "language-meta" },
      [plural(language.labels.length, "gesture"), language.author].filter(Boolean).join(" \u00b7 "),
    ),
    h("p", { className: "health", hidden: true }),
    h(
      "button",
      {
        type: "button",
        className: "last-change",
        title: `${dateAndTime(language.updated)}: show the history`,
        onclick: () => openHistory(language),
      },
      h("span", {}, language.change),
      h("time", { dateTime: language.updated }, ago(language.updated)),
    ),
  );
  if (focused)
    /** @type {HTMLElement | undefined} */ (card.getElementsByClassName(focused)[0])?.focus();
  showHealth(card, language);
  return card;
}
