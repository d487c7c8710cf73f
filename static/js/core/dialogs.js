// A modal dialog with a form; it stays open and shows the error until its task succeeds.

import { byId, h } from "./dom.js";
import { limit } from "./text-limit.js";

/** @import { Field } from "./types.d.ts" */

/**
 * Show an element in the dialog of the page; its heading has the id `dialog-title`.
 *
 * @param {Node} content
 * @param {(() => void) | null} [closed]
 */
export function showDialog(content, closed = null) {
  const dialog = byId("dialog");
  dialog.replaceChildren(content);
  dialog.setAttribute("aria-labelledby", "dialog-title");
  dialog.onclose = closed;
  dialog.showModal();
}

export const closeDialog = () => byId("dialog").close();

/**
 * Ask for values in a dialog.
 *
 * `fields` are `{ name, label, value, required, hint, multiline, most }`. `submit(values)` does the
 * task; its error is shown in the dialog. Resolves to what `submit` returned, or null. `refusal` is
 * the button's text that does nothing.
 *
 * @param {{ title: string, text?: string, fields: Field[], action: string, refusal?: string, submit: (values: Record<string, string>) => any, preview?: HTMLElement | null }} question
 * @returns {Promise<any>}
 */
export function ask({
  title,
  text = "",
  fields,
  action,
  refusal = "Cancel",
  submit,
  preview = null,
}) {
  const problem = h("p", { className: "field-problem", role: "alert", hidden: true });
  const confirm = h("button", { type: "submit", className: "primary" }, action);
  const inputs = fields.map((field) => inputOf(field));
  return new Promise((resolve) => {
    /** @type {any} */
    let answer = null;
    const form = h(
      "form",
      { method: "dialog", noValidate: true },
      h("h2", { id: "dialog-title" }, title),
      text ? h("p", { className: "dim" }, text) : null,
      preview,
      fields.map((field, index) => rowOf(field, inputs[index])),
      problem,
      h(
        "div",
        { className: "dialog-actions" },
        h("button", { type: "button", onclick: closeDialog }, refusal),
        confirm,
      ),
    );
    form.onsubmit = async (event) => {
      event.preventDefault();
      const empty = fields.findIndex(
        (field, index) => field.required && !inputs[index].value.trim(),
      );
      if (empty >= 0)
        return showProblem(`${fields[empty].label} is empty; type one.`, inputs[empty]);
      confirm.disabled = true;
      try {
        answer = await submit(
          Object.fromEntries(
            fields.map((field, index) => [field.name, inputs[index].value.trim()]),
          ),
        );
        closeDialog();
      } catch (error) {
        if (error.code === "cancelled") return closeDialog();
        showProblem(error.message, inputs[0]);
      } finally {
        confirm.disabled = false;
      }
    };
    /** @type {(message: string, input?: HTMLElement) => void} */
    const showProblem = (message, input) => {
      problem.textContent = message;
      problem.hidden = false;
      input?.focus();
    };
    showDialog(form, () => resolve(answer));
    inputs[0]?.select?.();
  });
}

/** @param {Field} field */
function inputOf(field) {
  const properties = {
    id: `field-${field.name}`,
    name: field.name,
    value: field.value ?? "",
    autocomplete: "off",
    required: Boolean(field.required),
  };
  const input = field.multiline
    ? h("textarea", { ...properties, rows: 2 })
    : h("input", { ...properties, type: "text" });
  return limit(input, field.most ?? 2000);
}

/**
 * @param {Field} field
 * @param {HTMLElement} input
 */
function rowOf(field, input) {
  return h(
    "div",
    { className: "field" },
    h(
      "label",
      { for: input.id },
      field.label,
      field.required ? null : h("span", { className: "dim" }, " (optional)"),
    ),
    input,
    field.hint ? h("p", { className: "dim" }, field.hint) : null,
  );
}
