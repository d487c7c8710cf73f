// The preview of a draft: its trajectory image, its descriptors, and the gestures near it.

import { readable } from "../core/format.js";
import { html, nothing, svg } from "../templates.js";

/** @import { Descriptor, Outlook, Preview } from "../core/types.d.ts" */

const HEIGHT = 22; // of a descriptor's drawing, in its own units

/**
 * A descriptor: bars around a line, or the number itself if there is only one.
 *
 * @param {Descriptor} descriptor
 */
function descriptor({ voter, unit, values }) {
  const most = Math.max(...values.map(Math.abs)) || 1;
  const bars = values.map((value, index) => {
    const size = (HEIGHT / 2) * (Math.abs(value) / most);
    return svg`<rect
      x=${index}
      width="0.7"
      y=${value < 0 ? HEIGHT / 2 : HEIGHT / 2 - size}
      height=${Math.max(0.3, size)}
    />`;
  });
  return html`<li title="${readable(voter)}: distances in ${unit}">
    <span class="name">${readable(voter)}</span>${
      values.length === 1
        ? html`<span class="num">${values[0].toFixed(3)}</span>`
        : html`<svg
            viewBox="0 0 ${values.length} ${HEIGHT}"
            preserveAspectRatio="none"
            role="img"
            aria-label="${values.length} numbers, the largest ${most.toFixed(2)}"
          >
            ${bars}
          </svg>`
    }
  </li>`;
}

/**
 * The image and the descriptors.
 *
 * @param {Preview | null} preview
 * @param {string | null} drawing the newest image, which an incomplete draft keeps
 */
export function image(preview, drawing) {
  const { problem, seconds = null, strokes, descriptors = [] } = preview ?? {};
  return html`<section class="panel image-panel" aria-label="Trajectory image">
    <div class="panel-head">
      <h2>Trajectory image</h2>
      <small class="dim num">${seconds === null ? "" : `${seconds.toFixed(2)} s`}</small>
    </div>
    <div class="image-box">
      ${
        drawing
          ? html`<img
              class="trajectory ${problem ? "stale" : ""}"
              alt="Trajectory image of the gesture, from the dot along the arrow"
              width="224"
              height="224"
              src=${drawing}
            />`
          : html`<p>Nothing to draw yet</p>`
      }
    </div>
    ${strokes ? html`<p class="strokes">Strokes: ${strokes}</p>` : nothing}
    <p class="field-problem" role="alert" ?hidden=${!problem}>
      ${problem && `It cannot be saved like this: ${problem}.`}
    </p>
    <details ?hidden=${!descriptors.length}>
      <summary>Descriptors of the image</summary>
      <ul class="descriptors" aria-label="Descriptors">
        ${descriptors.map(descriptor)}
      </ul>
    </details>
  </section>`;
}

/** @typedef {NonNullable<Outlook["nearest"]>[number]} NearGesture */

/**
 * A gesture near the edited one, with a mark where the two cannot be told apart.
 *
 * @param {NearGesture} near
 * @param {NearGesture | undefined} before
 */
function nearRow({ label, distance, same }, before) {
  const was =
    before && before.distance.toFixed(2) !== distance.toFixed(2)
      ? html`<small class="dim"> (saved: ${before.distance.toFixed(2)})</small>`
      : nothing;
  return html`<li class=${same ? "bad" : "good"}>
    <span
      class="verdict"
      role="img"
      aria-label=${same ? "The robot cannot distinguish the two" : "Another movement"}
      >${same ? "!" : "\u2713"}</span
    >
    <span><b>${label}</b>${was}</span>
    <b class="num">${distance.toFixed(2)}</b>
  </li>`;
}

/**
 * @param {Outlook | null} found
 * @param {string | null | undefined} problem
 */
function noteOn(found, problem) {
  if (!found)
    return problem ? "Nothing can be compared before the gesture is complete." : "Comparing\u2026";
  if (found.nearest === null)
    return "Without a demonstration nothing can be compared: choose a clip that shows the gesture.";
  return found.nearest.length
    ? "Distance of the nearest gestures, 1 for two typical ones. What other people reach is measured once three have shown the language."
    : "The only gesture of a language cannot be confused with another.";
}

/**
 * The near gestures, compared with those of the saved gesture; the newest stay while others are
 * looked for.
 *
 * @param {string} name
 * @param {{ found: Outlook | null, newest: Outlook | null, before: Outlook | null, problem: string | null | undefined }} outlooks
 */
export const health = (name, { found, newest, before, problem }) =>
  html`<section class="panel health-panel" aria-label="Health">
    <h2>Health of ${name} with it</h2>
    <p class="dim" role="status">${noteOn(found, problem)}</p>
    <ul class="estimates ${found ? "" : "stale"}" aria-label="Nearest gestures">
      ${(newest?.nearest ?? []).map((near) =>
        nearRow(
          near,
          before?.nearest?.find(({ label }) => label === near.label),
        ),
      )}
    </ul>
  </section>`;
