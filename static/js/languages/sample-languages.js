// The sample languages that are not in the library, each a button that adds it.

import * as api from "../core/api.js";
import { h, WRITES } from "../core/dom.js";
import { plural } from "../core/format.js";
import { state } from "../core/state.js";
import { attempt } from "../core/toasts.js";
import { addSampleLanguage } from "./language-actions.js";

/** @import { SampleLanguage } from "../core/types.d.ts" */

/** @type {SampleLanguage[] | null} */
let samples = null;

/** @param {SampleLanguage} sample */
const present = (sample) =>
  state.languages.some((language) => language.sample && language.name === sample.title);

/** @param {SampleLanguage} sample */
function offer(sample) {
  const button = h(
    "button",
    { type: "button", className: "sample-language", ...WRITES },
    h("b", {}, sample.title),
    h(
      "span",
      { className: "dim" },
      `${plural(sample.labels.length, "gesture")}: ${sample.labels.join(", ")}`,
    ),
  );
  button.onclick = async () => {
    button.disabled = true;
    await addSampleLanguage(sample);
    button.disabled = false;
  };
  return h("li", {}, button);
}

/**
 * Draw the buttons, or nothing where all samples are in the library.
 *
 * @param {HTMLElement} box
 */
export async function drawSampleLanguages(box) {
  samples ??= await attempt("Loading the samples", api.samples.languages);
  const missing = (samples ?? []).filter((sample) => !present(sample));
  box.hidden = !missing.length;
  box.replaceChildren(
    h("h2", {}, "Sample languages"),
    h("ul", { className: "sample-languages" }, missing.map(offer)),
  );
}
