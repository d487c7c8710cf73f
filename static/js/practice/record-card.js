// The records of practice: the evidence that each diver's takes give, and the takes themselves.

import { askWhich, percent, plural } from "../core/format.js";
import { placeIn, state } from "../core/state.js";
import { address, go, here } from "../core/views.js";
import { html, iconButtonOf, nothing, progressBar } from "../templates.js";

/** @import { PracticeRecord, PracticeTake } from "../core/types.d.ts" */

/** @typedef {(take: PracticeTake) => void} Remove */

/**
 * The evidence of a record in words, and what is missing.
 *
 * @param {Omit<PracticeRecord, "diver" | "older" | "pairs" | "shown">} record
 */
export function evidenceOf({ takes, errors, bound, limit: most, reached, more, confidence }) {
  const counted = `${plural(errors, "error")} in ${plural(takes, "take")}`;
  const sure = `${percent(confidence)} confidence`;
  return reached
    ? `${counted}: under ${percent(most)} errors, by ${sure} at most ${(100 * bound).toFixed(1)} %.`
    : `${counted}: ${plural(more, "more take")} without an error for under ${percent(most)} errors at ${sure}.`;
}

/** @param {PracticeTake} take */
function readAs({ right, pair, label }) {
  if (right) return " recognised";
  return pair ? ` asked back: ${askWhich(pair)}` : ` read as ${label ?? "nothing"}`;
}

/**
 * @param {PracticeTake} take
 * @param {Remove} remove
 */
function takeRow(take, remove) {
  const { right, pair, expected, revision, added_by: by } = take;
  const clip = state.clips.find(({ id }) => id === take.clip_id);
  const place = placeIn(take.clip_id, { recognition: take.recognition_id });
  return html`<li class=${right ? "right" : pair ? "asked" : "wrong"}>
    <span aria-hidden="true">${right ? "\u2713" : pair ? "?" : "\u2260"}</span>
    <span
      ><b>${expected}</b>${readAs(take)}<small class="dim">
        revision ${revision}${by ? `, added by ${by}` : ""}</small
      ></span
    >
    ${
      clip
        ? html`<a href=${address("studio", place)} @click=${here(() => go("studio", place))}
            >${clip.name}</a
          >`
        : html`<span class="dim">its clip was deleted</span>`
    }${iconButtonOf("close", `Remove this take of ${expected}`, () => remove(take), {
      writes: true,
    })}
  </li>`;
}

/**
 * @param {PracticeRecord} record
 * @param {Remove} remove
 */
export function recordCard(record, remove) {
  const { diver, reached, takes, more, pairs, older, shown } = record;
  const note = (/** @type {number} */ count, /** @type {string} */ words) =>
    count ? html`<p class="dim">${plural(count, "take")} ${words}</p>` : nothing;
  return html`<section class="practice-record ${reached ? "reached" : ""}" aria-label=${diver}>
    <h3>${diver}${reached ? " \u2713" : ""}</h3>
    <p>${evidenceOf(record)}</p>
    ${progressBar(`Takes of ${diver}`, takes, takes + more)}
    ${note(pairs, "asked back with the right gesture: neither right nor an error.")}${note(
      older,
      "with older revisions of the language do not count.",
    )}
    <details>
      <summary>${plural(shown.length, "take")}</summary>
      <ul class="practice-takes">
        ${shown.map((take) => takeRow(take, remove))}
      </ul>
    </details>
  </section>`;
}
