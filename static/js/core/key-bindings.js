// The key bindings: one list, which `?` also shows.

/** @import { Binding } from "./types.d.ts" */

/** @type {Binding[]} */
const bound = [];

const TYPED_IN =
  "input:not([type=range]):not([type=checkbox]):not([type=radio]), textarea, select, [contenteditable=true]";

/**
 * Bind keys to a function. `keys` are written as for people, "Ctrl+Shift+Z" or "Shift+,"; the first
 * one is shown. `when()` says whether the binding applies now; of several, the last one wins. Plain
 * keys do nothing in text fields. No key may override one of the browser's.
 *
 * @param {{ keys: string[], text: string, group: string, run: (event: KeyboardEvent) => unknown, when?: () => boolean }} binding
 */
export function bind({ keys, text, group, run, when = () => true }) {
  bound.push({ keys, text, group, run, when });
}

/**
 * A key press in the notation of `bind`: with Shift, too, the key's own letter or sign.
 *
 * @param {KeyboardEvent} event
 * @returns {string}
 */
function written(event) {
  const name =
    event.key === " "
      ? "Space"
      : event.code.startsWith("Key")
        ? event.code.slice(3)
        : ({ Comma: ",", Period: ".", BracketLeft: "[", BracketRight: "]" }[event.code] ??
          event.key);
  const held = [
    event.ctrlKey || event.metaKey ? "Ctrl" : "",
    event.altKey ? "Alt" : "",
    event.shiftKey && event.key !== "?" ? "Shift" : "",
  ];
  return [...held.filter(Boolean), name].join("+");
}

/** @type {Promise<unknown> | null} */
let opening = null; // A view that is being loaded: its keys are not bound yet.

/**
 * Hold back pressed keys until a promise is settled.
 *
 * @param {Promise<unknown>} promise
 */
export function holdKeys(promise) {
  opening = promise;
  promise.finally(() => {
    if (opening === promise) opening = null;
  });
}

/** @param {string} combination */
const meant = (combination) =>
  bound.findLast((each) => each.keys.includes(combination) && each.when());

/** @param {KeyboardEvent} event */
function pressed(event) {
  if (event.defaultPrevented || document.querySelector("dialog[open]")) return;
  // An element of a frame is not an instance of this window's Element.
  const at =
    event.target && "closest" in event.target ? /** @type {Element} */ (event.target) : null;
  if (at?.closest(TYPED_IN)) return;
  // The space bar presses the focused button.
  if (event.key === " " && at?.closest("button, summary, [role=tab], [role=button]")) return;
  const combination = written(event);
  if (opening) {
    if (event.key === " ") event.preventDefault(); // It would scroll the page.
    opening.then(() => meant(combination)?.run(event));
    return;
  }
  const found = meant(combination);
  if (!found) return;
  event.preventDefault();
  found.run(event);
}

/**
 * Handle the keys that are pressed in a window: this one, or a frame in it.
 *
 * @param {Window} [target]
 */
export function listenToKeys(target = window) {
  target.addEventListener("keydown", pressed);
}

/** The bindings made so far, in their order; read only. */
export const bindings = () => bound;
