// The draft of a gesture: unsaved changes with their own undo, kept by the browser.

import { demonstrationOf } from "../clips/demonstration-ranges.js";
import { browserStore } from "../core/browser-store.js";
import { byId } from "../core/dom.js";
import { selectedRange, state } from "../core/state.js";
import { labelIfNew, labelOf } from "../gestures/gesture-rows.js";
import { written } from "../languages/robot-command.js";
import { NONE } from "../languages/test-set.js";

/** @import { Gesture, Language, SelectedRange, SwitchName } from "../core/types.d.ts" */

/**
 * A range of a clip, as the API takes it.
 *
 * @typedef {{ clip_id: string, start: number, end: number, keep_transit: boolean }} Where
 */

/**
 * The edited values; `salient` null means the proposed keypoints, `clip` null the saved
 * demonstration.
 *
 * @typedef {Pick<Gesture, "label" | "description" | SwitchName> & { command: string, salient: string[] | null, clip: Where | null }} Draft
 */

const KEY = "osg-studio.draft"; // A draft outlives its tab, and a crash.
const MOST_STEPS = 200; // Of undo: an hour of tireless clicking, a few hundred bytes each.
const SHELF_LIFE = 30 * 24 * 3600e3; // ms. An older draft is dropped.

/** @type {string | null} */
let place = null; // the key under which the draft is stored
/** @type {Draft | null} */
let base = null;
/** @type {Draft | null} */
let now = null;
/** @type {Draft[]} */
let past = [];
/** @type {Draft[]} */
let future = [];
/** @type {string | null} */
let typing = null; // the text field that the newest step belongs to
let listener = () => {};

/**
 * Whether the clip of a demonstration can be shown.
 *
 * @param {Pick<Where, "clip_id"> | null | undefined} where
 */
export const isThere = (where) =>
  where && state.clips.some(({ id, status }) => id === where.clip_id && status === "done");

/**
 * The gesture that is edited, for code that runs only where there is one.
 *
 * @param {{ language: Language, gesture: string | null }} about
 */
export function gestureOf({ language, gesture }) {
  const found = language.gestures.find(({ label }) => label === gesture);
  if (!found) throw new Error(`No gesture is called ${gesture}.`);
  return found;
}

/**
 * The values that a draft begins with.
 *
 * @param {{ language: Language, gesture: string | null }} about
 * @returns {Draft}
 */
export function valuesOf({ language, gesture }) {
  if (gesture === null) {
    const { start, end } = /** @type {SelectedRange} */ (selectedRange());
    const name = state.clips.find(({ id }) => id === state.clip)?.name ?? "";
    const clip = { clip_id: state.clip ?? "", start, end, keep_transit: false };
    const expected = byId("expected").value;
    return {
      label: labelIfNew((expected !== NONE && expected) || labelOf(name), language, clip),
      description: "",
      command: "",
      salient: null,
      direction: "auto",
      tempo: "auto",
      mirror: "auto",
      hand_shape: "auto",
      clip,
    };
  }
  const shown = gestureOf({ language, gesture });
  const { label, description, command, salient, direction, tempo, mirror, source } = shown;
  return {
    label,
    description,
    command: written(command),
    salient: salient.length ? [...salient].sort() : null,
    direction,
    tempo,
    mirror,
    hand_shape: shown.hand_shape,
    clip: source && isThere(source) ? demonstrationOf(source) : null,
  };
}

/**
 * @param {unknown} one
 * @param {unknown} other
 */
const same = (one, other) => JSON.stringify(one) === JSON.stringify(other);

/**
 * A draft, for code that runs only while there is one.
 *
 * @param {Draft | null} values
 */
function begun(values) {
  if (!values) throw new Error("No gesture is edited.");
  return values;
}

/** The draft as it is; read only. */
export const draft = () => begun(now);

/** The values that the draft began from; read only. */
export const saved = () => begun(base);

export const isChanged = () => now !== null && !same(now, base);
/** Whether there is a changed draft that comes back when the gesture is opened again. */
export const isKept = () => isChanged() && read(place) !== null;

export const canUndo = () => past.length > 0;
export const canRedo = () => future.length > 0;

/**
 * The storage key of a gesture's draft; a new gesture is identified by where it is shown.
 *
 * @param {string} language
 * @param {string} gesture
 */
export const placeOf = (language, gesture) => `${KEY}.${language}.${gesture}`;

/**
 * Begin with `values`, or with the draft kept from another time. `changed()` is called after every
 * change. Returns when the kept draft was left, in ms, or null.
 *
 * @param {string} at
 * @param {Draft} values
 * @param {() => void} changed
 * @returns {number | null}
 */
export function begin(at, values, changed) {
  [place, base, now, past, future, typing, listener] = [at, values, values, [], [], null, changed];
  const kept = read(at);
  if (!kept || same(kept.values, values)) return null;
  now = { ...values, ...kept.values };
  past = [values];
  return kept.time;
}

/**
 * Change some values. Typing on in the same `field` stays one step.
 *
 * @param {Partial<Draft>} values
 * @param {string | null} [field]
 */
export function change(values, field = null) {
  const next = { ...draft(), ...values };
  if (same(next, now)) return;
  if (field === null || field !== typing) past = [...past, draft()].slice(-MOST_STEPS);
  typing = field;
  future = [];
  turn(next);
}

/** Called when the text field loses the focus: further typing is another step. */
export const rest = () => {
  typing = null;
};

export function undo() {
  const before = past.at(-1);
  if (!before) return;
  future = [...future, draft()];
  turn(before, past.slice(0, -1));
}

export function redo() {
  const next = future.at(-1);
  if (!next) return;
  past = [...past, draft()];
  future = future.slice(0, -1);
  turn(next);
}

/**
 * @param {Draft} next
 * @param {Draft[]} [steps]
 */
function turn(next, steps = past) {
  [now, past] = [next, steps];
  keep();
  listener();
}

/**
 * Keep what was changed as the draft of another gesture, which has every other value as saved.
 *
 * @param {string} at
 */
export function takeAlong(at) {
  const changes = Object.entries(draft()).filter(
    ([name, value]) => !same(value, saved()[/** @type {keyof Draft} */ (name)]),
  );
  forget();
  const values = Object.fromEntries(changes);
  browserStore.write(at, { values, time: Date.now() });
}

/** Delete the draft, after it was saved or dropped. */
export function forget() {
  if (place) browserStore.set(place, null);
}

/** Drop the draft and go back to what it began from; one undo brings it back. */
export function discard() {
  change(saved());
}

function keep() {
  if (place && isChanged()) browserStore.write(place, { values: now, time: Date.now() });
  else forget();
}

/**
 * @param {string | null} at
 * @returns {{ values: Draft, time: number } | null}
 */
function read(at) {
  const kept = at && browserStore.read(at);
  return kept && Date.now() - kept.time < SHELF_LIFE ? kept : null;
}
