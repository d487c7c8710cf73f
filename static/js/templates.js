// Templates: what lit-html draws from the state is changed in place, so that focus survives.

import { Directive, directive } from "../vendor/lit-html/directive.js";
import { ifDefined } from "../vendor/lit-html/directives/if-defined.js";
import { live } from "../vendor/lit-html/directives/live.js";
import { html, noChange, nothing, render } from "../vendor/lit-html/lit-html.js";
import { ICONS } from "./core/dom.js";
import { limit } from "./core/text-limit.js";

export { guard } from "../vendor/lit-html/directives/guard.js";
export { ifDefined } from "../vendor/lit-html/directives/if-defined.js";
export { live } from "../vendor/lit-html/directives/live.js";
export { repeat } from "../vendor/lit-html/directives/repeat.js";
export { until } from "../vendor/lit-html/directives/until.js";
export { html, noChange, nothing, render, svg } from "../vendor/lit-html/lit-html.js";

/** @import { ElementPart } from "../vendor/lit-html/directive.js" */
/** @import { TemplateResult } from "../vendor/lit-html/lit-html.js" */

class Limited extends Directive {
  isLimited = false;

  /** @param {number} most */
  render(most) {
    return most;
  }

  /**
   * @override
   * @param {ElementPart} part
   * @param {[number]} values
   */
  update({ element }, [most]) {
    if (!this.isLimited) limit(/** @type {HTMLInputElement} */ (element), most);
    this.isLimited = true;
    return noChange;
  }
}

/** Let the field of a template take so many code points: `<input ${limited(80)} />`. */
export const limited = directive(Limited);

/**
 * One of the line icons; it is decoration, so its button needs a label of its own.
 *
 * @param {string} name
 */
export const iconOf = (name) =>
  html`<svg viewBox="0 0 20 20" aria-hidden="true"><path d=${ICONS[name]} /></svg>`;

/**
 * A small button that shows only an icon; `disabled` if it would have no effect.
 *
 * @param {string} name
 * @param {string} label
 * @param {() => unknown} run
 * @param {{ writes?: boolean, id?: string, disabled?: boolean }} [more]
 */
export const iconButtonOf = (name, label, run, { writes = false, id, disabled = false } = {}) =>
  html`<button
    type="button"
    class="quiet icon"
    id=${ifDefined(id)}
    title=${label}
    aria-label=${label}
    ?data-writes=${writes}
    ?disabled=${disabled}
    @click=${run}
  >
    ${iconOf(name)}
  </button>`;

/**
 * A button with words.
 *
 * @param {unknown} words
 * @param {() => unknown} run
 * @param {{ look?: string, writes?: boolean, title?: string, label?: string, id?: string, disabled?: unknown, hidden?: boolean, pressed?: boolean }} [more]
 */
export const buttonOf = (
  words,
  run,
  { look, writes, title, label, id, disabled, hidden, pressed } = {},
) =>
  html`<button
    type="button"
    class=${ifDefined(look)}
    id=${ifDefined(id)}
    title=${ifDefined(title)}
    aria-label=${ifDefined(label)}
    aria-pressed=${ifDefined(pressed)}
    ?data-writes=${writes}
    ?disabled=${disabled}
    ?hidden=${hidden}
    @click=${run}
  >
    ${words}
  </button>`;

/**
 * A bar of progress; it moves by itself while the total is not known.
 *
 * @param {string} label
 * @param {number | undefined} done
 * @param {number | undefined} total
 */
export const progressBar = (label, done, total) =>
  html`<progress
    aria-label=${label}
    max=${total || 1}
    value=${ifDefined(total ? done : undefined)}
  ></progress>`;

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

/**
 * Options whose text is their value.
 *
 * @param {string[]} values
 * @returns {[string, string][]}
 */
export const asOptions = (values) => values.map((each) => [each, each]);

/**
 * The options of a choice, each `[value, text]`; the choice is blank where none has the value.
 *
 * @param {[string, string][]} options
 * @param {string} value
 */
export const optionsOf = (options, value) => [
  options.some(([each]) => each === value)
    ? nothing
    : html`<option hidden value="" .selected=${live(true)}></option>`,
  options.map(
    ([each, text]) =>
      html`<option value=${each} .selected=${live(each === value)}>${text}</option>`,
  ),
];
