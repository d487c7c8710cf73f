// The card of a language in the library.

import * as api from "../core/api.js";
import { ago, dateAndTime, plural } from "../core/format.js";
import { menu } from "../core/menu.js";
import { state } from "../core/state.js";
import { address, go, here } from "../core/views.js";
import { guard, html, ifDefined, nothing } from "../templates.js";
import { healthLine } from "./card-health.js";
import { duplicate, openHistory, remove, rename } from "./language-actions.js";
import { choose } from "./language-store.js";

/** @import { LanguageSummary } from "../core/types.d.ts" */

const PICTURES = 5; // One row of a card; the others are only counted.

/** @param {LanguageSummary} language */
function pictures({ id, revision, labels }) {
  if (!labels.length) return html`<p class="no-gestures dim">No gestures yet</p>`;
  const shown = labels.slice(0, labels.length > PICTURES ? PICTURES - 1 : PICTURES);
  const rest = labels.slice(shown.length);
  return html`<ul class="thumbnails" aria-label="Gestures">
    ${shown.map(
      (label) =>
        html`<li>
          <img
            alt=${label}
            title=${label}
            loading="lazy"
            width="64"
            height="64"
            src=${api.languages.image(id, label, revision)}
          />
        </li>`,
    )}${
      rest.length ? html`<li class="rest" title=${rest.join(", ")}>+${rest.length}</li>` : nothing
    }
  </ul>`;
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
 * Draw a card.
 *
 * @param {LanguageSummary} language
 */
export function card(language) {
  const { id, labels, author, updated, change, sample } = language;
  const current = id === state.language;
  const place = { language: id, recognition: null, panel: null, older: null, newer: null };
  const facts = [plural(labels.length, "gesture"), author].filter(Boolean).join(" \u00b7 ");
  return html`<li class="language ${current ? "current" : ""}" data-language=${id}>
    <div class="language-head">
      <h2>
        <a
          href=${address("studio", place)}
          class="language-name"
          aria-current=${ifDefined(current ? "true" : undefined)}
          @click=${here(() => work(language))}
          >${language.name}</a
        >
      </h2>
      ${current ? html`<span class="tag chosen">in use</span>` : nothing}${
        sample ? html`<span class="tag">sample</span>` : nothing
      }${guard([JSON.stringify(language)], () => commands(language))}
    </div>
    ${pictures(language)}
    <p class="language-meta">${facts}</p>
    ${healthLine(language)}
    <button
      type="button"
      class="last-change"
      title="${dateAndTime(updated)}: show the history"
      @click=${() => openHistory(language)}
    >
      <span>${change}</span><time datetime=${updated}>${ago(updated)}</time>
    </button>
  </li>`;
}
