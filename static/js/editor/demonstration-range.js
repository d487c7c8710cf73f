// The range of a demonstration in its clip: a take's gesture, all of a take, or a range by hand.

import { LEAST_FRAMES, nearestFrame } from "../clips/frame-times.js";

/** @import { Take } from "../core/types.d.ts" */

/** @import { Where } from "./gesture-draft.js" */

const SAME_MOMENT = 1e-3; // s, as the server compares a range with a take

/**
 * @param {number} one
 * @param {number} other
 */
const near = (one, other) => Math.abs(one - other) <= SAME_MOMENT;

/**
 * The take whose whole range, from salute to salute, is selected; null for a range by hand.
 *
 * @param {Where | null} where
 * @param {Take[]} takes
 */
export const takeOf = (where, takes) =>
  (where && takes.find((take) => near(take.start, where.start) && near(take.end, where.end))) ??
  null;

/**
 * First and last frame of a range; null, a demonstration stored in the language, means all.
 *
 * @param {Where | null} where
 * @param {Take[]} takes
 * @param {number[]} time
 * @returns {[number, number]}
 */
export function framesOf(where, takes, time) {
  if (!where) return [0, time.length - 1];
  const take = takeOf(where, takes);
  const [start, end] =
    take && !where.keep_transit ? [take.stroke_start, take.stroke_end] : [where.start, where.end];
  return [nearestFrame(time, start), nearestFrame(time, end)];
}

/**
 * A whole take of a clip, or the whole clip if it has no salutes.
 *
 * @param {string} clip
 * @param {Take[]} takes
 * @param {number[]} time
 * @param {number} [index]
 * @returns {Where}
 */
export function wholeOf(clip, takes, time, index = 0) {
  const take = takes[index];
  return {
    clip_id: clip,
    start: take?.start ?? 0,
    end: take?.end ?? time.at(-1) ?? 0,
    keep_transit: false,
  };
}

/**
 * The range with one end moved to a frame: from then on it is a range by hand.
 *
 * @param {Where} where
 * @param {Take[]} takes
 * @param {number[]} time
 * @param {"start" | "end"} which
 * @param {number} frame
 * @returns {Where}
 */
export function movedTo(where, takes, time, which, frame) {
  const last = time.length - 1;
  const [start, end] = framesOf(where, takes, time);
  const least = LEAST_FRAMES - 1;
  const ends =
    which === "start"
      ? [Math.max(0, Math.min(frame, end - least)), end]
      : [start, Math.min(last, Math.max(frame, start + least))];
  return { clip_id: where.clip_id, start: time[ends[0]], end: time[ends[1]], keep_transit: false };
}
