// The recognitions of the live view: the newest one large, the others in a list.

import { endName } from "../clips/salutes.js";
import { askWhich, moment, percent } from "../core/format.js";
import { placeIn, state } from "../core/state.js";
import { go } from "../core/views.js";
import { buttonOf, html, nothing, repeat } from "../templates.js";

/** @import { Clip } from "../core/types.d.ts" */
/** @import { Recognized } from "../camera/live-messages.d.ts" */

/**
 * A recognition, of a clip or of the camera, at a time of day.
 *
 * @typedef {{ result: Recognized, clip: Clip | null, clock: string }} Result
 */

/** @param {Recognized} result */
function verdict(result) {
  if (result.label !== null)
    return {
      title: result.label,
      text: `${percent(result.confidence ?? 0)} sure`,
    };
  if (result.pair)
    return { title: askWhich(result.pair), text: "It lies between these two: show it again" };
  if (result.problem) return { title: "Not judged", text: result.problem };
  return { title: "No gesture of this language", text: `nearest is ${result.nearest}` };
}

/**
 * The class of a recognition: a question looks otherwise than a rejection.
 *
 * @param {Recognized} result
 */
const lookOf = ({ label, pair }) => (pair ? "asked" : label === null ? "unsure" : "");

/**
 * The list entry of a recognition; for a clip, a link to the take and its explanation.
 *
 * @param {Result} shown
 */
function entry({ result, clip, clock }) {
  const { title, text } = verdict(result);
  const place = placeIn(clip?.id, { start: result.start, end: result.end });
  const open = buttonOf("Open", () => go("studio", place), {
    look: "link",
    label: `Open ${title} at ${moment(result.start)} in the studio`,
  });
  return html`<li class=${lookOf(result)}>
    <b>${title}</b>
    <span
      >${clip ? moment(result.start) : clock}${
        result.closed ? "" : `, no closing ${endName(state.gestures)}`
      }
      · ${text}</span
    >
    ${clip ? open : nothing}
  </li>`;
}

/**
 * The newest recognition, or `told` where there is something else to say.
 *
 * @param {Result[]} results
 * @param {string} told
 */
export function newestOf([newest], told) {
  const result = told ? null : newest?.result;
  const { title, text } = result ? verdict(result) : { title: "", text: told };
  const meter = html`<meter
    min="0"
    max="1"
    value=${result?.confidence ?? 0}
    aria-label="Confidence"
  ></meter>`;
  return html`<div class="live-result ${result ? lookOf(result) : ""}" aria-live="polite">
    ${title ? html`<strong>${title}</strong>` : nothing}${result?.label ? meter : nothing}
    <p>${text}</p>
  </div>`;
}

/**
 * The recognitions, the newest first.
 *
 * @param {Result[]} results
 */
export const listOf = (results) =>
  html`<ol class="live-recognised" aria-label="Recognised, newest first">
    ${repeat(results, (each) => each, entry)}
  </ol>`;
