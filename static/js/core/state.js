// The state of the page, in one place; the part that a link restores is in the URL.

/** @import { Clip, Language, SelectedRange, State } from "./types.d.ts" */

/**
 * The values that a link restores.
 *
 * @type {(keyof State)[]}
 */
const IN_URL = [
  "view",
  "source",
  "clip",
  "take",
  "start",
  "end",
  "frame",
  "language",
  "gesture",
  "recognition",
  "joint",
  "panel",
  "older",
  "newer",
  "pair",
  "cell",
  "phrase",
  "shown",
  "paused",
];
const NUMBERS = new Set(["take", "start", "end", "frame", "older", "newer"]);

/** @type {State} */
const values = {
  .../** @type {any} */ (Object.fromEntries(IN_URL.map((name) => [name, null]))),
  clips: [],
  offered: null,
  library: { last: null, older: 0 },
  uploads: [],
  jobs: new Map(),
  takes: null,
  samples: [],
  timeline: null,
  position: null,
  languages: [],
  gestures: null,
  result: null,
  why: null,
  trial: null,
  question: null,
  role: null,
  quota: null,
  connected: null,
  returns: 0,
  loaded: false,
  health: null,
  checking: null,
  unfolded: null,
  invitations: null,
  exporting: null,
  tabling: null,
  testSet: null,
  testing: null,
  labelled: null,
  pending: [],
  ranges: [],
};

/** @type {{ names: (keyof State)[], react: (state: State) => void }[]} */
const listeners = [];

let returning = false; // by Back or Forward: the URL is already set

/** The present values; read only. */
export const state = values;

/** @type {(change: Partial<State>) => (keyof State)[]} */
const keysOf = (change) => /** @type {any} */ (Object.keys(change));

/**
 * Change values, update the URL, and call the listeners of the changed values.
 *
 * @param {Partial<State>} change
 */
export function update(change) {
  const changed = keysOf(change).filter((name) => values[name] !== change[name]);
  if (!changed.length) return;
  Object.assign(values, change);
  // Only another view makes an entry in the browser's history.
  if (!returning && changed.some((name) => IN_URL.includes(name)))
    writeUrl(changed.includes("view"));
  for (const { names, react } of listeners)
    if (names.some((name) => changed.includes(name))) react(values);
}

/**
 * Call `react` now, and whenever one of the named values changes.
 *
 * @param {(keyof State)[]} names
 * @param {(state: State) => void} react
 */
export function follow(names, react) {
  listeners.push({ names, react });
  react(values);
}

/**
 * Resolve once the lists of clips, samples and languages are loaded.
 *
 * @returns {Promise<void>}
 */
export const whenLoaded = () =>
  new Promise((resolve) => follow(["loaded"], ({ loaded }) => loaded && resolve()));

/**
 * Read the state that is in the URL.
 *
 * @returns {Partial<State>}
 */
export function readUrl() {
  const query = new URLSearchParams(location.search);
  /** @type {Record<string, string | number | null>} */
  const change = {};
  for (const name of IN_URL) {
    const text = query.get(name);
    const number = Number.parseFloat(text ?? "");
    if (!NUMBERS.has(name)) change[name] = text;
    else change[name] = Number.isFinite(number) ? number : null;
  }
  return change;
}

/** Follow the browser's Back and Forward. */
export function followHistory() {
  addEventListener("popstate", () => {
    returning = true;
    update(readUrl());
    returning = false;
  });
}

/** @param {boolean} another */
function writeUrl(another) {
  const query = new URLSearchParams();
  for (const name of IN_URL) {
    const value = /** @type {any} */ (values)[name];
    if (value !== null && value !== undefined)
      query.set(name, NUMBERS.has(name) ? String(Math.round(value * 1000) / 1000) : value);
  }
  const text = query.toString();
  const url = text ? `?${text}` : location.pathname;
  if (another) history.pushState(null, "", url);
  else history.replaceState(null, "", url);
}

/**
 * The part of the state that shows a clip, or a range of it and its recognition.
 *
 * @param {string | null | undefined} clip
 * @param {{ recognition?: string | null, start?: number | null, end?: number | null }} [range]
 */
export const placeIn = (clip, { recognition = null, start = null, end = null } = {}) => ({
  clip,
  recognition,
  take: null,
  start,
  end,
  frame: null,
});

/** @returns {Clip | null} */
export const selectedClip = () => values.clips.find((clip) => clip.id === values.clip) ?? null;

/**
 * Whether the clip on display can be shown: its poses are found, or takes have ended in the frames
 * so far.
 */
export function isReadable() {
  const status = selectedClip()?.status;
  return status === "done" || (status === "running" && Boolean(values.takes?.length));
}

/**
 * Seconds the clip lasts, by its last frame; before its poses are found, by its container.
 *
 * @param {Clip} clip
 */
export const lengthOf = (clip) => values.timeline?.time.at(-1) ?? clip.duration ?? 0;

/**
 * The range in seconds on which buttons act, and whether it is the range of a take.
 *
 * @returns {SelectedRange | null}
 */
export function selectedRange() {
  const clip = selectedClip();
  if (!clip) return null;
  const take = values.takes?.[values.take ?? -1];
  if (take)
    return { start: take.start, end: take.end, shown: [take.stroke_start, take.stroke_end], take };
  const start = values.start ?? 0;
  const end = values.end ?? lengthOf(clip);
  return { start, end, shown: [start, end], take: null };
}

/**
 * The language on display, for code that runs only while there is one.
 *
 * @returns {Language}
 */
export function currentLanguage() {
  if (!values.gestures) throw new Error("No language is on display.");
  return values.gestures;
}
