// The sample languages that are not in the library, each a button that adds it.

import * as api from "../core/api.js";
import { disableDuring } from "../core/dom.js";
import { plural } from "../core/format.js";
import { state } from "../core/state.js";
import { attempt } from "../core/toasts.js";
import { html, nothing } from "../templates.js";
import { addSampleLanguage } from "./language-actions.js";

/** @import { SampleLanguage } from "../core/types.d.ts" */

/** @type {SampleLanguage[] | null} */
let samples = null;

/** @param {SampleLanguage} sample */
const present = (sample) =>
  state.languages.some((language) => language.sample && language.name === sample.title);

/** @param {SampleLanguage} sample */
const offer = (sample) =>
  html`<li>
    <button
      type="button"
      class="sample-language"
      data-writes
      @click=${(/** @type {any} */ { currentTarget }) =>
        disableDuring(currentTarget, () => addSampleLanguage(sample))}
    >
      <b>${sample.title}</b>
      <span class="dim"
        >${plural(sample.labels.length, "gesture")}: ${sample.labels.join(", ")}</span
      >
    </button>
  </li>`;

export async function loadSampleLanguages() {
  samples ??= await attempt("Loading the samples", api.samples.languages);
}

/** Draw the buttons, or nothing where all samples are in the library. */
export function sampleLanguages() {
  const missing = (samples ?? []).filter((sample) => !present(sample));
  if (!missing.length) return nothing;
  return html`<section class="samples-offer" aria-label="Sample languages">
    <h2>Sample languages</h2>
    <ul class="sample-languages">
      ${missing.map(offer)}
    </ul>
  </section>`;
}
