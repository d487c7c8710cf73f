// Two revisions of a language side by side, gesture by gesture.

import { beside } from "../core/server.js";
import { plural } from "../core/format.js";
import { html, nothing } from "../templates.js";

/** @import { Gesture, GestureDiff, Revision, RevisionDiff } from "../core/types.d.ts" */

const SIGNS = { added: "+", removed: "\u2212", changed: "\u2260", same: "=" };

/** @param {Gesture | null} gesture */
const picture = (gesture) =>
  gesture
    ? html`<figure>
        <img
          alt="Trajectory of ${gesture.label}"
          loading="lazy"
          width="112"
          height="112"
          src=${beside(gesture.thumbnail)}
        />
        <figcaption>${gesture.label}</figcaption>
      </figure>`
    : html`<figure class="absent">
        <span>not there</span>
        <figcaption>${"\u00a0"}</figcaption>
      </figure>`;

/**
 * @param {string} look
 * @param {string[]} words
 */
const list = (look, words) =>
  words.length
    ? html`<ul class=${look}>
        ${words.map((word) => html`<li>${word}</li>`)}
      </ul>`
    : nothing;

/** @param {GestureDiff} gesture */
const row = ({ kind, before, after, words }) =>
  html`<li class="compared ${kind}">
    ${picture(before)}${picture(after)}
    <div class="compared-text">
      <span class="kind"><span aria-hidden="true">${SIGNS[kind]}</span>${kind}</span>
      <b>${(after ?? before)?.label}</b>
      ${list("", words)}
    </div>
  </li>`;

/** @param {Revision | null} revision */
const heading = (revision) => (revision ? `Revision ${revision.revision}` : "Nothing");

/**
 * The answer of `GET /languages/{id}/comparison`.
 *
 * @param {RevisionDiff} diff
 */
export function comparison({ older, newer, words, gestures }) {
  const changed = gestures.filter((each) => each.kind !== "same");
  const same = gestures.filter((each) => each.kind === "same");
  /** @param {string} kind */
  const count = (kind) => gestures.filter((each) => each.kind === kind).length;
  const counts = ["added", "removed", "changed"]
    .map((kind) => (count(kind) ? `${count(kind)} ${kind}` : null))
    .filter(Boolean)
    .join(", ");
  return html`<p class="diff-summary">
      ${counts ? `Gestures: ${counts}.` : "The gestures are the same."}
    </p>
    ${list("comparison-words", words)}${
      changed.length
        ? html`<div class="comparison-heads" aria-hidden="true">
              <span>${heading(older)}</span>
              <span>${heading(newer)}</span>
            </div>
            <ul class="compared-list" aria-label="What changed">
              ${changed.map(row)}
            </ul>`
        : nothing
    }${
      same.length
        ? html`<details class="unchanged">
            <summary>${plural(same.length, "gesture")} unchanged</summary>
            <ul class="compared-list">
              ${same.map(row)}
            </ul>
          </details>`
        : nothing
    }`;
}
