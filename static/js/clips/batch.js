// The clips whose poses are found one after the other: how many are done, and the time for all.

/** @import { Batch, Clip, Job } from "../core/types.d.ts" */

/**
 * The states of a clip whose poses are still to be found.
 *
 * @type {Set<Clip["status"]>}
 */
export const BUSY = new Set(["queued", "running"]);

const LEAST_FRAMES = 20; // frames done before a rate is computed
const FRAMES_UNKNOWN = 200; // assumed for a clip whose container has no count

/** @type {(clip: Clip) => number} */
const framesOf = (clip) => clip.frames || FRAMES_UNKNOWN;

/**
 * Update the batch: it begins with the first waiting clip, includes clips added later, and ends
 * when none waits or runs; null without a batch.
 *
 * @param {Batch | null} batch
 * @param {Clip[]} clips
 * @param {Map<string, Job>} jobs
 * @param {number} now milliseconds
 * @returns {Batch | null}
 */
export function follow(batch, clips, jobs, now) {
  const busy = clips.filter(({ status }) => BUSY.has(status));
  if (!busy.length) return null;
  const members = new Set(batch?.members ?? []);
  for (const { id } of busy) members.add(id);
  const known = clips.filter(({ id }) => members.has(id));
  const doneOf = (/** @type {Clip} */ clip) =>
    BUSY.has(clip.status) ? (jobs.get(clip.job_id)?.done ?? 0) : framesOf(clip);
  const frames = known.reduce((sum, clip) => sum + doneOf(clip), 0);
  const left = busy.reduce((sum, clip) => sum + Math.max(0, framesOf(clip) - doneOf(clip)), 0);
  const began = batch?.began ?? (frames ? { frames, at: now } : null);
  return { members: [...members], began, frames, left, at: now };
}

/**
 * Seconds left for all clips of a batch; null while the rate is not known.
 *
 * @param {Batch} batch
 */
export function secondsLeft({ began, frames, left, at }) {
  if (!began || frames - began.frames < LEAST_FRAMES || at <= began.at) return null;
  return ((at - began.at) / 1000 / (frames - began.frames)) * left;
}

/**
 * The clips that wait, in the order in which they run: the oldest first.
 *
 * @param {Clip[]} clips
 */
export const queueOf = (clips) =>
  clips
    .filter(({ status }) => status === "queued")
    .sort((one, other) => one.created.localeCompare(other.created));
