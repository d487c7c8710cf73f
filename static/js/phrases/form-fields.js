// Fields of the phrases' form. Each saves when it loses the focus or Enter is pressed.

import { byId, h, icon } from "../core/dom.js";
import { limit } from "../core/text-limit.js";

let drawing = false;

/** Replace the content of `root`, keeping the focus, the caret and unsaved input. */
export function redraw(root, ...content) {
  /** @type {any} */
  const active = root.contains(document.activeElement) ? document.activeElement : null;
  const typing =
    active &&
    "defaultValue" in active &&
    active.type !== "checkbox" &&
    active.value !== active.defaultValue
      ? active.value
      : null;
  const caret = typing === null ? null : active.selectionStart;
  drawing = true;
  root.replaceChildren(...content.filter(Boolean));
  drawing = false;
  const again = active?.id ? byId(active.id) : null;
  if (!again) return;
  if (typing !== null) again.value = typing;
  again.focus();
  if (caret !== null && again.type !== "number") again.setSelectionRange(caret, caret);
}

/**
 * A labelled text field; `commit(text)` saves what was typed and resolves to whether it could be.
 *
 * @param {any} field
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
    input.defaultValue = input.value; // a second "leave" has nothing more to save
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

/** @type {(field: any) => HTMLElement} */
export const numberField = ({ min, max, step = 1, ...rest }) =>
  textField({
    ...rest,
    type: "number",
    min,
    max,
    step,
    inputMode: step === 1 ? "numeric" : "decimal",
  });

/** A labelled choice among `options`, each `[value, text]`. */
export function choice({ id, label, value, options, commit, hidden = false }) {
  const select = h(
    "select",
    { id, onchange: () => commit(select.value) },
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

export function checkbox({ id, label, checked, commit }) {
  const input = h("input", {
    type: "checkbox",
    id,
    checked,
    onchange: () => commit(input.checked),
  });
  return h("label", { className: "tick" }, input, label);
}

/** A small button that shows only an icon; disabled where it can do nothing. */
export function tool(id, name, label, run, disabled = false) {
  return h(
    "button",
    {
      type: "button",
      className: "quiet icon",
      id,
      title: label,
      "aria-label": label,
      onclick: run,
      disabled,
    },
    icon(name),
  );
}
