// The sample clips, each a button that adds it to the library.

import * as api from "../core/api.js";
import { byId, disableDuring } from "../core/dom.js";
import { attempt } from "../core/toasts.js";
import { html, iconOf, nothing, render } from "../templates.js";
import { loadClip } from "./clip-pages.js";
import { select } from "./clip-store.js";

/** @import { Sample, State } from "../core/types.d.ts" */

/**
 * A sample's file name as a title: "circle_a_demonstration.mp4" without underscores and ending.
 *
 * @param {string} name
 */
const readable = (name) => name.replace(/\.\w+$/, "").replace(/[_-]+/g, " ");

/**
 * Add a sample clip and show it; resolves to its id, or null.
 *
 * @param {Sample} sample
 * @param {HTMLButtonElement} button
 */
export async function addSampleClip(sample, button) {
  const accepted = await disableDuring(button, () =>
    attempt("Adding the sample", () => api.samples.add(sample.name)),
  );
  if (!accepted) return null;
  await attempt("Loading the clip", () => loadClip(accepted.id));
  select(accepted.id);
  return accepted.id;
}

/**
 * The list of sample clips, each a button that adds it.
 *
 * @param {Sample[]} samples
 */
export const samplesList = (samples) =>
  html`<ul class="samples">
    ${samples.map((sample) => {
      const add = (/** @type {any} */ { currentTarget }) => addSampleClip(sample, currentTarget);
      return html`<li>
        <button type="button" data-writes @click=${add}>
          ${iconOf("plus")}${readable(sample.name)}
        </button>
      </li>`;
    })}
  </ul>`;

/**
 * Offer the sample clips in the library, folded away.
 *
 * @param {State} state
 */
export function drawSampleClips({ samples }) {
  const list = html`<details>
    <summary>Sample clips</summary>
    ${samplesList(samples)}
  </details>`;
  render(samples.length ? list : nothing, byId("samples"));
}
