// Fields of the phrases' form. Each saves when it loses the focus or Enter is pressed.

import { byId, h, icon, WRITES } from "../core/dom.js";
import { limit } from "../core/text-limit.js";

/**
 * A labelled text field; `commit(text)` saves the typed text, and resolves to false if that failed.
 *
 * @typedef {object} TextField
 * @property {string} id
 * @property {string} label
 * @property {string} value
 * @property {(text: string) => unknown} commit
 * @property {boolean} [multiline]
 * @property {boolean} [hidden] whether the label is for screen readers only
 * @property {number} [most] code points
 * @property {string} [placeholder]
 */

/** @typedef {TextField & { min: number, max: number, step?: number | "any" }} NumberField */

let drawing = false;

/**
 * The unsaved text of a field and the position of its caret; null without any.
 *
 * @param {Element | null} field
 */
function unsavedIn(field) {
  const nothing = { typing: null, caret: null };
  if (!(field instanceof HTMLInputElement || field instanceof HTMLTextAreaElement)) return nothing;
  if (field.type === "checkbox" || field.value === field.defaultValue) return nothing;
  return { typing: field.value, caret: field.selectionStart };
}

/**
 * Replace the content of `root`, keeping the focus, the caret and unsaved input.
 *
 * @param {HTMLElement} root
 * @param {...(Node | null)} content
 */
export function redraw(root, ...content) {
  const active = root.contains(document.activeElement) ? document.activeElement : null;
  const { typing, caret } = unsavedIn(active);
  drawing = true;
  root.replaceChildren(...content.filter((each) => each !== null));
  drawing = false;
  const again = active?.id ? byId(active.id) : null;
  if (!again) return;
  if (typing !== null) again.value = typing;
  again.focus();
  if (caret !== null && again.type !== "number") again.setSelectionRange(caret, caret);
}

/**
 * Make a text field.
 *
 * @param {TextField & Record<string, unknown>} field
 */
export function textField({
  id,
  label,
  value,
  commit,
  multiline = false,
  hidden = false,
  most = Number.POSITIVE_INFINITY,
  ...more
}) {
  const input = h(multiline ? "textarea" : "input", {
    id,
    ...WRITES,
    defaultValue: value,
    autocomplete: "off",
    ...(multiline
      ? { rows: Math.min(8, Math.max(2, value.split("\n").length)) }
      : { type: "text" }),
    ...more,
  });
  limit(input, most);
  const leave = async () => {
    if (drawing || input.value === input.defaultValue) return;
    const before = input.defaultValue;
    input.defaultValue = input.value; // a second blur has nothing more to save
    if ((await commit(input.value)) === false && input.isConnected) {
      input.defaultValue = before;
      input.value = before;
    }
  };
  input.onblur = leave;
  input.onkeydown = (event) => {
    if (event.key === "Enter" && !multiline) leave();
    if (event.key === "Escape" && input.value !== input.defaultValue) {
      input.value = input.defaultValue;
      event.stopPropagation();
    }
  };
  return h(
    "div",
    { className: "field-line" },
    h("label", { for: id, className: hidden ? "visually-hidden" : "" }, label),
    input,
  );
}

/** @type {(field: NumberField) => HTMLElement} */
export const numberField = ({ min, max, step = 1, ...rest }) =>
  textField({
    ...rest,
    type: "number",
    min,
    max,
    step,
    inputMode: step === 1 ? "numeric" : "decimal",
  });

/**
 * Options whose text is their value.
 *
 * @param {string[]} values
 * @returns {[string, string][]}
 */
export const asOptions = (values) => values.map((each) => [each, each]);

/**
 * A labelled choice among `options`, each `[value, text]`.
 *
 * @template {string} V
 * @param {{ id: string, label: string, value: V, options: [V, string][], commit: (value: V) => unknown, hidden?: boolean }} field
 */
export function choice({ id, label, value, options, commit, hidden = false }) {
  const select = h(
    "select",
    { id, ...WRITES, onchange: () => commit(/** @type {V} */ (select.value)) },
    options.map(([key, text]) => h("option", { value: key }, text)),
  );
  select.value = value;
  return h(
    "div",
    { className: "field-line" },
    h("label", { for: id, className: hidden ? "visually-hidden" : "" }, label),
    select,
  );
}

/** @param {{ id: string, label: string, checked: boolean, commit: (on: boolean) => unknown }} field */
export function checkbox({ id, label, checked, commit }) {
  const input = h("input", {
    type: "checkbox",
    ...WRITES,
    id,
    checked,
    onchange: () => commit(input.checked),
  });
  return h("label", { className: "tick" }, input, label);
}

/**
 * A small button that shows only an icon; `disabled` if it would have no effect.
 *
 * @param {string} id
 * @param {string} name
 * @param {string} label
 * @param {() => unknown} run
 * @param {boolean} [disabled]
 */
export function tool(id, name, label, run, disabled = false) {
  return h(
    "button",
    {
      type: "button",
      className: "quiet icon",
      ...WRITES,
      id,
      title: label,
      "aria-label": label,
      onclick: run,
      disabled,
    },
    icon(name),
  );
}
