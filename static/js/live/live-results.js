// The recognitions of the live view: the newest one large, the others in a list.

import { byId } from "../core/dom.js";
import { askWhich, moment, percent } from "../core/format.js";
import { endName } from "../clips/salutes.js";
import { placeIn, state } from "../core/state.js";
import { go } from "../core/views.js";
import { buttonOf, elementOf, html, nothing, render } from "../templates.js";

/** @import { Clip } from "../core/types.d.ts" */
/** @import { Recognized } from "../camera/live-messages.d.ts" */

const MOST = 50; // in the list; a practice session has fewer.

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
 * @param {Recognized} result
 * @param {Clip | null} clip
 * @param {string} clock
 */
function entry(result, clip, clock) {
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
 * Show a recognition, of a clip or of the camera.
 *
 * @param {Recognized} result
 * @param {Clip | null} clip
 */
export function addResult(result, clip) {
  const { title, text } = verdict(result);
  const box = byId("live-result");
  box.className = `live-result ${lookOf(result)}`;
  const meter = html`<meter
    min="0"
    max="1"
    value=${result.confidence ?? 0}
    aria-label="Confidence"
  ></meter>`;
  render(
    html`<strong>${title}</strong>${result.label === null ? nothing : meter}
      <p>${text}</p>`,
    box,
  );
  const list = byId("live-recognised");
  list.prepend(elementOf(entry(result, clip, new Date().toLocaleTimeString())));
  while (list.children.length > MOST) list.lastChild?.remove();
  byId("live-clear").hidden = false;
}

/**
 * Show that nothing was recognised in a clip; `rate` is the frames processed per second.
 *
 * @param {Clip} clip
 * @param {number | null} rate
 */
export function showNothingRecognised(clip, rate) {
  const looked =
    rate === null
      ? "No frame of it could be looked at in time"
      : `${rate.toFixed(1)} frames a second of it were looked at`;
  render(
    html`<p>
      Nothing was recognised in ${clip.name}. ${looked}; tick “Every frame” and play it again to
      miss none.
    </p>`,
    byId("live-result"),
  );
}

/**
 * Forget what was recognised.
 *
 * @param {string} text
 */
export function clearResults(text) {
  byId("live-recognised").replaceChildren();
  byId("live-clear").hidden = true;
  const box = byId("live-result");
  box.className = "live-result nothing";
  render(html`<p>${text}</p>`, box);
}
