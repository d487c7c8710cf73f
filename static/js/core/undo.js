// Undo and redo of what was done in this tab, kept over reloads until the tab closes.

import { tabStore } from "./browser-store.js";
import { byId } from "./dom.js";
import { bind } from "./key-bindings.js";
import { complain, toast } from "./toasts.js";

/** @import { Action, UndoHandlers } from "./types.d.ts" */

const KEY = "osg-studio.undo"; // A tab undoes what was done in it.
const MOST = 100;

/** @type {{ done: Action[], undone: Action[] }} */
let { done, undone } = tabStore.read(KEY) ?? { done: [], undone: [] };

// One after another: a key press or an edit may come while the one before waits for the server.
let working = Promise.resolve();

/** @type {Map<string, UndoHandlers>} */
const kinds = new Map();

/**
 * Register how actions of a kind are undone: `undo(action)` and `redo(action)` call the server and
 * resolve when it has answered; `record(action)`, if given, returns the action that is recorded.
 *
 * @param {string} kind
 * @param {{ undo: (action: any) => Promise<unknown>, redo: (action: any) => Promise<unknown>, record?: (action: any) => Action }} handlers
 */
export function registerUndo(kind, { undo, redo, record = (action) => action }) {
  kinds.set(kind, { undo, redo, record });
}

/** @param {Action} action */
const handlersOf = ({ kind }) => /** @type {UndoHandlers} */ (kinds.get(kind));

/**
 * Record an action: plain data, `{ title, kind, ... }`, of a kind that is registered. An undo or
 * redo that is still waiting for the server is recorded before it.
 *
 * @param {Action} action
 */
export function recordAction(action) {
  working = working.then(() => {
    done = [...done, handlersOf(action).record(action)].slice(-MOST);
    undone = [];
    keep();
  });
}

/**
 * @param {Action[]} from
 * @param {Action[]} to
 * @param {"undo" | "redo"} how
 * @param {string} words
 */
async function step(from, to, how, words) {
  const action = from.at(-1);
  if (!action) return;
  removeUndoButtons();
  try {
    await handlersOf(action)[how](action);
    from.pop();
    to.push(action);
    keep();
    toast(words, action.title);
  } catch (error) {
    complain(error, how === "undo" ? "Undoing" : "Redoing");
  }
}

/** Undo the newest action; resolves when that is done. */
export const undo = () => (working = working.then(() => step(done, undone, "undo", "Undone")));

/** Redo the action that was undone last; resolves when that is done. */
export const redo = () => (working = working.then(() => step(undone, done, "redo", "Redone")));

function keep() {
  tabStore.write(KEY, { done, undone });
}

/** Undo applies to the newest action only, so older messages must not offer it any more. */
function removeUndoButtons() {
  for (const other of byId("toasts").querySelectorAll(".undoable")) other.remove();
}

/**
 * Show a message about an action, with an Undo button.
 *
 * @param {string} title
 * @param {string} [detail]
 */
export function showDone(title, detail = "") {
  removeUndoButtons();
  const message = toast(title, detail, { action: { label: "Undo", run: undo } });
  message.classList.add("undoable");
}

/** Bind the keys for undo and redo. */
export function bindUndo() {
  bind({ keys: ["Ctrl+Z"], text: "Undo", group: "Everywhere", run: undo });
  bind({ keys: ["Ctrl+Shift+Z", "Ctrl+Y"], text: "Redo", group: "Everywhere", run: redo });
}
