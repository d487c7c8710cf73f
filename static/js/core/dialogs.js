// A modal dialog with a form; it stays open and shows the error until its task succeeds.

import { html, limited, nothing, render } from "../templates.js";
import { byId, h } from "./dom.js";

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
  const form = h("form", { method: "dialog", noValidate: true });
  const inputOf = (/** @type {Field} */ { name }) => byId(`field-${name}`);
  const textOf = (/** @type {Field} */ field) => inputOf(field).value.trim();
  return new Promise((resolve) => {
    /** @type {any} */
    let answer = null;
    form.onsubmit = async (event) => {
      event.preventDefault();
      const empty = fields.find((field) => field.required && !textOf(field));
      if (empty) return refuse(`${empty.label} is empty; type one.`, empty);
      draw("", true);
      try {
        answer = await submit(
          Object.fromEntries(fields.map((field) => [field.name, textOf(field)])),
        );
        closeDialog();
      } catch (error) {
        if (error.code === "cancelled") return closeDialog();
        refuse(error.message, fields[0]);
      }
      return undefined;
    };
    /** @type {(problem: string, field?: Field) => void} */
    const refuse = (problem, field) => {
      draw(problem);
      if (field) inputOf(field).focus();
    };
    const draw = (problem = "", busy = false) =>
      render(
        html`<h2 id="dialog-title">${title}</h2>
          ${text ? html`<p class="dim">${text}</p>` : nothing}${preview}${fields.map(row)}
          <p class="field-problem" role="alert" ?hidden=${!problem}>${problem}</p>
          <div class="dialog-actions">
            <button type="button" @click=${closeDialog}>${refusal}</button>
            <button type="submit" class="primary" ?disabled=${busy}>${action}</button>
          </div>`,
        form,
      );
    draw();
    showDialog(form, () => resolve(answer));
    if (fields.length) inputOf(fields[0]).select();
  });
}

/** @param {Field} field */
function row({ name, label, value = "", required = false, hint, multiline, most = 2000 }) {
  const id = `field-${name}`;
  const input = multiline
    ? html`<textarea
        id=${id}
        name=${name}
        rows="2"
        autocomplete="off"
        ?required=${required}
        .defaultValue=${value}
        ${limited(most)}
      ></textarea>`
    : html`<input
        type="text"
        id=${id}
        name=${name}
        autocomplete="off"
        ?required=${required}
        .defaultValue=${value}
        ${limited(most)}
      />`;
  return html`<div class="field">
    <label for=${id}
      >${label}${required ? nothing : html`<span class="dim"> (optional)</span>`}</label
    >${input}${hint ? html`<p class="dim">${hint}</p>` : nothing}
  </div>`;
}
