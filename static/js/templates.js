// Templates: what lit-html draws from the state is changed in place, so that focus survives.

import { html, render } from "../vendor/lit-html/lit-html.js";
import { ICONS } from "./core/dom.js";

export { guard } from "../vendor/lit-html/directives/guard.js";
export { ifDefined } from "../vendor/lit-html/directives/if-defined.js";
export { live } from "../vendor/lit-html/directives/live.js";
export { repeat } from "../vendor/lit-html/directives/repeat.js";
export { until } from "../vendor/lit-html/directives/until.js";
export { html, nothing, render, svg } from "../vendor/lit-html/lit-html.js";

/** @import { TemplateResult } from "../vendor/lit-html/lit-html.js" */

/**
 * One of the line icons; it is decoration, so its button needs a label of its own.
 *
 * @param {string} name
 */
export const iconOf = (name) =>
  html`<svg viewBox="0 0 20 20" aria-hidden="true"><path d=${ICONS[name]} /></svg>`;

/**
 * Make the element of a template once, for a place that is not drawn from the state.
 *
 * @param {TemplateResult} template
 */
export function elementOf(template) {
  const holder = document.createElement("div");
  render(template, holder);
  return /** @type {HTMLElement} */ (holder.firstElementChild);
}
