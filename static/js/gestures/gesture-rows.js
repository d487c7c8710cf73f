// The rows of the table that makes gestures of clips: one per take, with a proposed label.

import { moment, plural } from "../core/format.js";
import { withoutJoiners } from "../core/joiners.js";

/** @import { Clip, GestureRow, Language, Take } from "../core/types.d.ts" */

const NAMED_BY_CAMERA = /^(img|vid|dscn?|gopr|gh|gx|mvi|mov|pxl|dji|clip|video)?[\d\s._-]*$/i;
const TRAILING = /[\s._-]+(demonstration|demo|test|take|clip|video|v?\d+)$/i;

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
 * The clips that the language's demonstrations come from.
 *
 * @param {Language | null} language
 */
const demonstrated = (language) =>
  new Set(
    (language?.gestures ?? []).flatMap(({ demonstrations }) =>
      demonstrations.map(({ source }) => source?.clip_id),
    ),
  );

/**
 * The clips that show no gesture of the language yet.
 *
 * @param {Clip[]} clips
 * @param {Language | null} language
 */
export function withoutGesture(clips, language) {
  const shown = demonstrated(language);
  return clips.filter(({ id }) => !shown.has(id));
}

/**
 * The rows of clips, in their order. A row is initially selected, unless its clip is already the
 * source of a gesture of the language, or its label occurs in the language or an earlier row.
 *
 * @param {Clip[]} clips
 * @param {Map<string, Take[]>} takes by clip, of those whose poses are found
 * @param {Language | null} language
 * @param {Map<string, Partial<GestureRow>>} edited what the user wrote or chose, by key
 * @returns {GestureRow[]}
 */
export function rowsOf(clips, takes, language, edited) {
  const shown = demonstrated(language);
  const taken = new Set((language?.labels ?? []).map(withoutJoiners));
  return clips.flatMap((clip) => {
    const found = takes.get(clip.id) ?? null;
    const alone = !found || found.length < 2;
    return (found?.length ? found : [null]).map((take, number) => {
      const key = alone ? clip.id : `${clip.id} ${number}`;
      const proposed = labelOf(clip.name);
      const label =
        edited.get(key)?.label ?? (alone || !proposed ? proposed : `${proposed} ${number + 1}`);
      const compared = withoutJoiners(label);
      const chosen = edited.get(key)?.chosen ?? (!shown.has(clip.id) && !taken.has(compared));
      if (chosen && label) taken.add(compared);
      return { key, clip, takes: found, take, number, label, chosen };
    });
  });
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
 * Why the selected rows cannot be saved yet: per key, and as one sentence; `others` are the labels
 * of the language.
 *
 * @param {GestureRow[]} rows
 * @param {string[]} others
 * @returns {{ problems: Map<string, string>, note: string }}
 */
export function problemsOf(rows, others) {
  const chosen = rows.filter((row) => row.chosen);
  const problems = new Map();
  const taken = new Set(others.map(withoutJoiners));
  const seen = new Set(taken);
  for (const { key, label } of chosen) {
    const text = label.trim();
    const compared = withoutJoiners(text);
    if (!text) problems.set(key, "Name it.");
    else if (seen.has(compared))
      problems.set(
        key,
        taken.has(compared)
          ? `The language has a gesture \u201c${text}\u201d already.`
          : `Another row is called \u201c${text}\u201d.`,
      );
    seen.add(compared);
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
