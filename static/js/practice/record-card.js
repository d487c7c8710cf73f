// The records of practice: the evidence that each diver's takes give, and the takes themselves.

import { answerOf, headsOf, takeLink, takeRow, takesTable } from "../clips/takes.js";
import { percent, plural } from "../core/format.js";
import { placeIn, state } from "../core/state.js";
import { html, iconButtonOf, nothing, progressBar } from "../templates.js";

/** @import { PracticeRecord, PracticeTake } from "../core/types.d.ts" */

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

/**
 * @param {PracticeTake} take
 * @param {(take: PracticeTake) => void} remove
 */
function row(take, remove) {
  const { expected, revision, added_by: by } = take;
  const clip = state.clips.find(({ id }) => id === take.clip_id);
  return takeRow([
    clip
      ? takeLink(clip.name, placeIn(take.clip_id, { recognition: take.recognition_id }))
      : html`<span class="dim">its clip was deleted</span>`,
    expected,
    answerOf(take, `revision ${revision}${by ? `, added by ${by}` : ""}`),
    iconButtonOf("close", `Remove this take of ${expected}`, () => remove(take), { writes: true }),
  ]);
}

/**
 * @param {PracticeRecord} record
 * @param {(take: PracticeTake) => void} remove
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
      ${takesTable(
        `Takes of ${diver}`,
        headsOf(["Clip", "Shows", "Read as", ""]),
        shown.map((take) => row(take, remove)),
      )}
    </details>
  </section>`;
}
