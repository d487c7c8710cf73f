// The rows of the table that makes gestures of clips: one per take, with a proposed label.

import { clipsOfDemonstrations } from "../clips/demonstration-ranges.js";
import { labelInName } from "../clips/clip-label.js";
import { moment, plural } from "../core/format.js";
import { withoutJoiners } from "../core/joiners.js";

/** @import { Choice, Clip, GestureRow, Language, Take, TakeRow } from "../core/types.d.ts" */

const NAMED_BY_CAMERA = /^(img|vid|dscn?|gopr|gh|gx|mvi|mov|pxl|dji|clip|video)?[\d\s._-]*$/i;
const NONE_IN_TABLE = "-"; // What the table of takes expects of one that shows none of the gestures.
const TRAILING = /[\s._-]+(demonstration|demo|test|take|clip|video|[tv]?\d+)$/i;

/**
 * The label that a clip's file name proposes, or "": "follow_me-demonstration-2.mp4" proposes
 * "follow me", and a camera's number nothing.
 *
 * @param {string} name
 */
export function labelOf(name) {
  let stem = name.replace(/\.[^.]{1,8}$/, "");
  if (/^\P{L}*$/u.test(stem) || (/\d/.test(stem) && NAMED_BY_CAMERA.test(stem))) return "";
  for (let shorter = stem.replace(TRAILING, ""); shorter !== stem;) {
    stem = shorter;
    shorter = stem.replace(TRAILING, "");
  }
  return stem.replace(/[\s._-]+/g, " ").trim();
}

/**
 * The label unless the language has the range as a demonstration of that gesture already; else "".
 *
 * @param {string} label
 * @param {Language} language
 * @param {{ clip_id: string, start: number, end: number }} range
 */
export function labelIfNew(label, { gestures }, { clip_id: clip, start, end }) {
  const sources = gestures
    .filter((each) => each.label === label)
    .flatMap(({ demonstrations }) => demonstrations.map(({ source }) => source));
  const shown = sources.some(
    (each) => each?.clip_id === clip && each.start < end && start < each.end,
  );
  return shown ? "" : label;
}

/**
 * The clips that show no gesture of the language yet.
 *
 * @param {Clip[]} clips
 * @param {Language | null} language
 */
export function withoutGesture(clips, language) {
  const shown = new Set(clipsOfDemonstrations(language));
  return clips.filter(({ id }) => !shown.has(id));
}

/** The key of a clip's take among readings. */
export const readingAt = (/** @type {string} */ clip, /** @type {number} */ number) =>
  `${clip} ${number}`;

/**
 * The rows of clips, in their order. A take of a gesture that the language has is a further
 * demonstration of it. A row is initially selected, unless its clip is already the source of a
 * gesture of the language, its label occurs in an earlier row, the language reads it right, it is a
 * take of the test set, or has no end. No other row's selection changes what the user decided.
 *
 * @param {Clip[]} clips
 * @param {Map<string, Take[]>} takes by clip, of those whose poses are found
 * @param {Language | null} language
 * @param {Map<string, Partial<GestureRow>>} edited what the user wrote or chose, by key
 * @param {Map<string, Pick<TakeRow, "label" | "expected">>} [readings] by the language, see `readingAt`
 * @returns {GestureRow[]}
 */
export function rowsOf(clips, takes, language, edited, readings = new Map()) {
  const shown = new Set(clipsOfDemonstrations(language));
  const labels = language?.labels ?? [];
  const known = new Map(labels.map((label) => [withoutJoiners(label), label]));
  /** @type {Set<string>} */
  const taken = new Set(); // labels of earlier rows that are initially selected
  return clips.flatMap((clip) => {
    const found = takes.get(clip.id) ?? null;
    const alone = !found || found.length < 2;
    return (found?.length ? found : [null]).map((take, number) => {
      const key = alone ? clip.id : `${clip.id} ${number}`;
      const reading = readings.get(readingAt(clip.id, number));
      const written = edited.get(key);
      const proposal = proposedLabel(clip, labels, reading, alone ? null : number);
      const label = written?.label ?? proposal;
      const { further, right } = asFurther(known.get(nameOf(label)), reading);
      const usual = !shown.has(clip.id) && isUsual(nameOf(proposal), take, known, taken, reading);
      const chosen = written?.chosen ?? usual;
      const why = whyLeftOut(written, chosen);
      return { key, clip, takes: found, take, number, label, chosen, further, right, why };
    });
  });
}

/**
 * Whether a take is selected unless the user decides; a new gesture then counts as taken.
 *
 * @param {string} proposed its proposed label
 * @param {Take | null} take
 * @param {Map<string, string>} known labels of the language
 * @param {Set<string>} taken
 * @param {Pick<TakeRow, "label" | "expected"> | undefined} reading
 */
function isUsual(proposed, take, known, taken, reading) {
  if (reading?.expected || take?.closed === false) return false;
  const { further, misread } = asFurther(known.get(proposed), reading);
  if (further) return misread;
  const first = !taken.has(proposed);
  if (proposed) taken.add(proposed);
  return first;
}

const nameOf = (/** @type {string} */ label) => withoutJoiners(label.trim());

/**
 * Why the last choice of the best has left a row out; empty while it is selected.
 *
 * @param {Partial<GestureRow> | undefined} written
 * @param {boolean} chosen
 */
const whyLeftOut = (written, chosen) => (chosen ? "" : (written?.why ?? ""));

/**
 * A take as a further demonstration of a gesture that the language has, if it has it.
 *
 * @param {string | undefined} further
 * @param {Pick<TakeRow, "label"> | undefined} reading
 */
function asFurther(further, reading) {
  if (!further) return { further: "", right: false, misread: false };
  const right = reading?.label === further;
  return { further, right, misread: reading !== undefined && !right };
}

/**
 * The expected gesture of a take, or the label that its clip's name proposes; `number` counts it
 * among several.
 *
 * @param {Clip} clip
 * @param {string[]} labels
 * @param {Pick<TakeRow, "expected"> | undefined} reading
 * @param {number | null} number
 */
function proposedLabel(clip, labels, reading, number) {
  const shown = reading?.expected === NONE_IN_TABLE ? "" : reading?.expected;
  const known = shown || labelInName(clip.name, labels);
  const proposed = known || labelOf(clip.name);
  return known || !proposed || number === null ? proposed : `${proposed} ${number + 1}`;
}

/**
 * The range that becomes the gesture, in words.
 *
 * @param {GestureRow} row
 */
export function rangeText({ clip, takes, take, number }) {
  if (!takes) return "";
  if (!take) return `the whole clip, ${moment(clip.duration ?? 0)}`;
  const which = takes.length > 1 ? `take ${number + 1} of ${takes.length}, ` : "";
  return `${which}${moment(take.stroke_start)} to ${moment(take.stroke_end)}`;
}

/**
 * What to check before a row is saved; empty if its take lies between two salutes.
 *
 * @param {GestureRow} row
 * @param {string} [name] what a diver holds before and after a gesture
 */
export function rangeWarning({ takes, take }, name = "Vulcan salute") {
  if (!takes) return "";
  if (!take) return `No ${name} was found: rest before and after the gesture becomes part of it.`;
  const second = name.replace("Vulcan ", "");
  return take.closed
    ? ""
    : `No second ${second} was found: the take goes on to the end of the clip.`;
}

/**
 * What a row becomes where that is no new gesture; empty for one.
 *
 * @param {Pick<GestureRow, "chosen" | "further" | "right">} row
 */
export function furtherNote({ chosen, further, right }) {
  if (!further || !(chosen || right)) return "";
  const already = right ? ` It is read as \u201c${further}\u201d already.` : "";
  return `A further demonstration of \u201c${further}\u201d.${already}`;
}

/**
 * Why the selected rows cannot be saved yet: per key, and as one sentence.
 *
 * @param {GestureRow[]} rows
 * @returns {{ problems: Map<string, string>, note: string }}
 */
export function problemsOf(rows) {
  const chosen = rows.filter((row) => row.chosen);
  const problems = new Map();
  const seen = new Set();
  for (const { key, label, further } of chosen) {
    const text = label.trim();
    const compared = nameOf(label);
    if (!text) problems.set(key, "Name it.");
    else if (seen.has(compared)) problems.set(key, `Another row is called \u201c${text}\u201d.`);
    if (!further) seen.add(compared);
  }
  const waiting = chosen.filter(({ takes }) => !takes);
  const unread = waiting.filter(({ clip }) => clip.status !== "done").length;
  const reason = unread
    ? `${plural(unread, "clip")} still without poses`
    : `Takes of ${plural(waiting.length, "clip")} not loaded yet`;
  const note = !chosen.length
    ? "No row is chosen."
    : problems.size
      ? `${plural(problems.size, "row")} without a name of ${problems.size > 1 ? "their" : "its"} own.`
      : waiting.length
        ? `${reason}: wait, or leave ${(unread || waiting.length) > 1 ? "them" : "it"} out.`
        : "";
  return { problems, note };
}

/**
 * The rows among which the best are chosen: new gestures that are selected, or that the last choice
 * has left out.
 *
 * @param {GestureRow[]} rows
 */
export const candidatesOf = (rows) =>
  rows.filter(({ takes, further, chosen, why }) => takes && !further && (chosen || why));

/**
 * What a choice changes of the rows it was made among, by key.
 *
 * @param {GestureRow[]} candidates
 * @param {Choice} choice
 * @returns {Map<string, { chosen: boolean, why: string }>}
 */
export function choiceOf(candidates, { left_out: out }) {
  const reasons = new Map(
    out.map(({ index, other, words }) => [
      index,
      `Left out; nearest is \u201c${other}\u201d: ${words}.`,
    ]),
  );
  return new Map(
    candidates.map(({ key }, index) => {
      const why = reasons.get(index) ?? "";
      return [key, { chosen: !why, why }];
    }),
  );
}
