// Fields of the phrases' form. Each saves when it loses the focus or Enter is pressed.

import {
  html,
  ifDefined,
  iconButtonOf,
  iconOf,
  limited,
  live,
  noChange,
  optionsOf,
  render,
} from "../templates.js";

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
 * @property {{ min: number, max: number, step: number | "any" }} [number] what a number may be
 */

/** @typedef {HTMLInputElement | HTMLTextAreaElement} Input */

let drawing = false;

/**
 * Draw a form anew; what is typed and not saved stays, also where its field goes.
 *
 * @param {HTMLElement} root
 * @param {unknown} content
 */
export function redraw(root, content) {
  drawing = true;
  render(content, root);
  drawing = false;
}

/**
 * The text of a field, unless another one is being typed in it.
 *
 * @param {string} id
 * @param {string} value
 */
function textOf(id, value) {
  const field = /** @type {Input | null} */ (document.activeElement);
  return live(field?.id === id && field.value !== field.defaultValue ? noChange : value);
}

/**
 * Save what was typed in a field.
 *
 * @param {Input} input
 * @param {TextField["commit"]} commit
 */
async function leave(input, commit) {
  if (drawing || input.value === input.defaultValue) return;
  const before = input.defaultValue;
  input.defaultValue = input.value; // a second blur has nothing more to save
  if ((await commit(input.value)) === false && input.isConnected) {
    input.defaultValue = before;
    input.value = before;
  }
}

/**
 * @param {KeyboardEvent & { target: any }} event
 * @param {TextField["commit"]} commit
 */
function press(event, commit) {
  const { key, target } = event;
  if (key === "Enter" && target.localName === "input") leave(target, commit);
  if (key !== "Escape" || target.value === target.defaultValue) return;
  target.value = target.defaultValue;
  event.stopPropagation();
}

/**
 * @param {string} id
 * @param {string} label
 * @param {boolean} hidden
 * @param {unknown} input
 */
const line = (id, label, hidden, input) =>
  html`<div class="field-line">
    <label for=${id} class=${hidden ? "visually-hidden" : ""}>${label}</label>${input}
  </div>`;

/** @param {TextField} field */
export function textField({ id, label, value, commit, multiline, hidden = false, ...more }) {
  const { most = Number.POSITIVE_INFINITY, placeholder, number } = more;
  const left = (/** @type {any} */ { target }) => leave(target, commit);
  const pressed = (/** @type {any} */ event) => press(event, commit);
  const input = multiline
    ? html`<textarea
        id=${id}
        data-writes
        autocomplete="off"
        rows=${Math.min(8, Math.max(2, value.split("\n").length))}
        placeholder=${ifDefined(placeholder)}
        .value=${textOf(id, value)}
        .defaultValue=${live(value)}
        @blur=${left}
        @keydown=${pressed}
        ${limited(most)}
      ></textarea>`
    : html`<input
        type=${number ? "number" : "text"}
        id=${id}
        data-writes
        autocomplete="off"
        placeholder=${ifDefined(placeholder)}
        min=${ifDefined(number?.min)}
        max=${ifDefined(number?.max)}
        step=${ifDefined(number?.step)}
        inputmode=${ifDefined(number && (number.step === 1 ? "numeric" : "decimal"))}
        .value=${textOf(id, value)}
        .defaultValue=${live(value)}
        @blur=${left}
        @keydown=${pressed}
        ${limited(most)}
      />`;
  return line(id, label, hidden, input);
}

/**
 * A labelled choice among `options`, each `[value, text]`.
 *
 * @template {string} V
 * @param {{ id: string, label: string, value: V, options: [V, string][], commit: (value: V) => unknown, hidden?: boolean }} field
 */
export const choice = ({ id, label, value, options, commit, hidden = false }) =>
  line(
    id,
    label,
    hidden,
    html`<select
      id=${id}
      data-writes
      @change=${(/** @type {any} */ { target }) => commit(target.value)}
    >
      ${optionsOf(options, value)}
    </select>`,
  );

/** @param {{ id: string, label: string, checked: boolean, commit: (on: boolean) => unknown }} field */
export const checkbox = ({ id, label, checked, commit }) =>
  html`<label class="tick"
    ><input
      type="checkbox"
      data-writes
      id=${id}
      .checked=${live(checked)}
      @change=${(/** @type {any} */ { target }) => commit(target.checked)}
    />${label}</label
  >`;

/**
 * A small button of the form that shows only an icon; `disabled` if it would have no effect.
 *
 * @param {string} id
 * @param {string} name
 * @param {string} label
 * @param {() => unknown} run
 * @param {boolean} [disabled]
 */
export const tool = (id, name, label, run, disabled) =>
  iconButtonOf(name, label, run, { writes: true, id, disabled });

/**
 * A button with a plus that adds something.
 *
 * @param {string} id
 * @param {string} text
 * @param {() => unknown} run
 * @param {string} [look]
 */
export const addButton = (id, text, run, look = "") =>
  html`<button type="button" class=${look} id=${id} data-writes @click=${run}>
    ${iconOf("plus")}${text}
  </button>`;
