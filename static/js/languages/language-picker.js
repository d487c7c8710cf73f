// The choice of a language in the header.

import { byId, h } from "../core/dom.js";
import { choose, newLanguage } from "./language-store.js";

/** @import { State } from "../core/types.d.ts" */

/** @param {State} state */
export function drawPicker({ languages, language, loaded }) {
  const picker = byId("language");
  picker.replaceChildren(...languages.map((each) => h("option", { value: each.id }, each.name)));
  if (!languages.length) picker.append(h("option", { value: "" }, loaded ? "No language yet" : ""));
  picker.disabled = !languages.length;
  picker.value = language ?? "";
}

/** Bind the choice of the language in the header. */
export function bindPicker() {
  /** @param {Event & { target: HTMLSelectElement }} event */
  byId("language").onchange = (event) => choose(event.target.value);
  byId("new-language").onclick = () => newLanguage();
}
