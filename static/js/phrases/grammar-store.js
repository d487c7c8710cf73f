// The grammar of the language on display, and saving edits of it.

import * as api from "../core/api.js";
import { state } from "../core/state.js";
import { attempt } from "../core/toasts.js";
import { edit } from "../languages/revision-edit.js";

/** @import { Grammar } from "../core/types.d.ts" */

/** @type {Grammar} */
const EMPTY = {
  start: null,
  end: null,
  cancel: null,
  timeout: 10,
  most_phrases: 1,
  slot_types: [],
  phrases: [],
};

export const grammar = () => state.gestures?.grammar ?? EMPTY;
export const labels = () => state.gestures?.gestures.map(({ label }) => label) ?? [];

let drawAgain = () => {};

/**
 * Call `react` when a step was refused: the form then shows an unsaved value.
 *
 * @param {() => void} react
 */
export const followRefusals = (react) => {
  drawAgain = react;
};

// Saved one after another: pressing a button may also leave a field, which saves it.
/** @type {Promise<boolean>} */
let working = Promise.resolve(true);

/**
 * Save what `step(grammar)` returns as one revision; null removes the phrases. Resolves to whether
 * it was saved.
 */
/** @type {(title: string, step: (grammar: Grammar) => Grammar | null) => Promise<boolean>} */
export function save(title, step) {
  working = working.then(async () => {
    const made = await attempt("Changing the phrases", () =>
      edit("Changing the phrases", title, (base) =>
        api.languages.change(base, { grammar: step(base.grammar ?? EMPTY) }),
      ),
    );
    if (!made) drawAgain();
    return made !== null;
  });
  return working;
}

/** Resolves when everything is saved, or refused. */
export const saved = () => working;
