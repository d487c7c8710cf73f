// The draft of a gesture: unsaved changes with their own undo, kept in localStorage.

const KEY = "osg-studio.draft"; // localStorage: a draft outlives its tab, and a crash.
const MOST_STEPS = 200; // Of undo: an hour of tireless clicking, a few hundred bytes each.
const SHELF_LIFE = 30 * 24 * 3600e3; // ms. Nobody remembers what a draft of last month was for.

let place = null; // under which the draft is kept
let base = null;
let now = null;
let past = [];
let future = [];
let typing = null; // the text field that the newest step belongs to
let listener = () => {};

const same = (one, other) => JSON.stringify(one) === JSON.stringify(other);

/** The draft as it is; read only. */
export const draft = () => now;

/** What the draft began from; read only. */
export const saved = () => base;

export const isChanged = () => now !== null && !same(now, base);
/** Whether there is a changed draft that comes back when the gesture is opened again. */
export const isKept = () => isChanged() && read(place) !== null;

export const canUndo = () => past.length > 0;
export const canRedo = () => future.length > 0;

/** The key of the draft of a gesture of a language; of a new one, by where it is shown. */
export const placeOf = (language, gesture) => `${KEY}.${language}.${gesture}`;

/**
 * Begin with `values`, or with the draft kept from another time. `changed()` is called after every
 * change. Returns when the kept draft was left, in ms, or null.
 */
export function begin(at, values, changed) {
  [place, base, now, past, future, typing, listener] = [at, values, values, [], [], null, changed];
  const kept = read(at);
  if (!kept || same(kept.values, values)) return null;
  now = { ...values, ...kept.values };
  past = [values];
  return kept.time;
}

/** Change some values. Typing on in the same `field` stays one step. */
/** @type {(values: object, field?: string | null) => void} */
export function change(values, field = null) {
  const next = { ...now, ...values };
  if (same(next, now)) return;
  if (field === null || field !== typing) past = [...past, now].slice(-MOST_STEPS);
  typing = field;
  future = [];
  turn(next);
}

/** The text field was left: what is typed next is another step. */
export const rest = () => {
  typing = null;
};

export function undo() {
  if (!canUndo()) return;
  future = [...future, now];
  turn(past.at(-1), past.slice(0, -1));
}

export function redo() {
  if (!canRedo()) return;
  past = [...past, now];
  const next = future.at(-1);
  future = future.slice(0, -1);
  turn(next);
}

function turn(next, steps = past) {
  [now, past] = [next, steps];
  keep();
  listener();
}

/** Forget the draft: it was saved, or is not wanted. */
export function forget() {
  if (place) localStorage.removeItem(place);
}

/** Drop the draft and go back to what it began from; one undo brings it back. */
export function discard() {
  change(base);
}

function keep() {
  try {
    if (isChanged()) localStorage.setItem(place, JSON.stringify({ values: now, time: Date.now() }));
    else forget();
  } catch {
    /* A full or forbidden store: the draft lives as long as its tab. */
  }
}

function read(at) {
  try {
    const kept = JSON.parse(localStorage.getItem(at) ?? "null");
    return kept && Date.now() - kept.time < SHELF_LIFE ? kept : null;
  } catch {
    return null;
  }
}
