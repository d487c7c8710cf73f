// The sample clips, each a button that adds it to the library.

import * as api from "../core/api.js";
import { byId, h, icon, WRITES } from "../core/dom.js";
import { attempt } from "../core/toasts.js";
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
  button.disabled = true;
  const accepted = await attempt("Adding the sample", () => api.samples.add(sample.name));
  button.disabled = false;
  if (!accepted) return null;
  await attempt("Loading the clip", () => loadClip(accepted.id));
  select(accepted.id);
  return accepted.id;
}

/**
 * Make the list of sample clips, each a button that adds it.
 *
 * @param {Sample[]} samples
 */
export function samplesList(samples) {
  return h(
    "ul",
    { className: "samples" },
    samples.map((sample) => {
      const button = h(
        "button",
        { type: "button", ...WRITES },
        icon("plus"),
        readable(sample.name),
      );
      button.onclick = () => addSampleClip(sample, button);
      return h("li", {}, button);
    }),
  );
}

/**
 * Offer the sample clips in the library, folded away.
 *
 * @param {State} state
 */
export function drawSampleClips({ samples }) {
  byId("samples").replaceChildren(
    ...(samples.length
      ? [h("details", {}, h("summary", {}, "Sample clips"), samplesList(samples))]
      : []),
  );
}
