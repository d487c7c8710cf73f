// The clips as the server has them: loading, selecting, and the progress of finding their poses.

import * as api from "../core/api.js";
import { duration, plural, timeLeft } from "../core/format.js";
import { refresh } from "../core/list-refresh.js";
import { state, update } from "../core/state.js";
import { registerUndo } from "../core/undo.js";
import { placeInQueue } from "./batch-card.js";
import { forget, newestFirst, take } from "./clip-pages.js";
import { BUSY } from "./busy.js";

/** @import { Clip, Job } from "../core/types.d.ts" */

/** @type {Record<string, string>} */
const STAGES = {
  queued: "Waiting in the queue",
  starting: "Starting",
  poses: "Finding poses",
  saving: "Saving",
};

/**
 * Load one clip that changed.
 *
 * @param {string} id
 */
export const reloadClip = (id) =>
  refresh(id, {
    load: api.clips.get,
    current: () => state.clips,
    order: newestFirst,
    take: (clips) => update({ clips }),
  });

/**
 * A key of what was read of a clip: another one once its pictures are turned.
 *
 * @param {Clip} clip
 */
export const versionOf = ({ id, turn }) => `${id} ${turn}`;

/**
 * Show another clip; the clip on display keeps its take, range and recognition.
 *
 * @param {string | null} id
 */
export function select(id) {
  if (id === state.clip) return;
  update({ clip: id, take: null, start: null, end: null, frame: null, recognition: null });
}

/**
 * Store a job's progress, as the server reports it.
 *
 * @param {Job} job
 */
export function followJob(job) {
  update({ jobs: new Map(state.jobs).set(job.id, job) });
  const clip = state.clips.find((each) => each.job_id === job.id);
  if (!clip || clip.status !== job.status) reloadClip(job.clip_id);
}

/**
 * Whether a clip is a dive recording whose topic is not chosen yet.
 *
 * @param {Clip} clip
 */
export const needsTopic = (clip) => clip.error_code === "topic_needed";

/**
 * @param {Clip} clip
 * @param {Job} [job]
 */
function progressText(clip, job) {
  if (clip.status === "queued") return placeInQueue(state.clips, clip);
  const stage = STAGES[job?.stage ?? ""] ?? STAGES[clip.status] ?? "Working";
  if (!job?.total || job.stage !== "poses") return stage;
  const left = job.eta_s === null ? "" : `, ${timeLeft(job.eta_s)}`;
  return `${stage}, ${job.done} of ${job.total} frames${left}`;
}

/**
 * The state of a clip in words.
 *
 * @param {Clip} clip
 * @param {Job} [job]
 */
export function statusText(clip, job) {
  if (needsTopic(clip)) return `${plural(clip.topics.length, "topic")}: choose one`;
  if (clip.status === "failed") return clip.error ?? "The poses could not be found.";
  if (clip.status === "cancelled") return "Cancelled before its poses were found";
  if (BUSY.has(clip.status)) return progressText(clip, job);
  return [
    clip.duration ? duration(clip.duration) : null,
    clip.frames ? plural(clip.frames, "frame") : null,
  ]
    .filter(Boolean)
    .join(" \u00b7 ");
}

registerUndo("clip", {
  undo: ({ id }) =>
    api.clips
      .restore(id)
      .then(take)
      .then(() => select(id)),
  redo: ({ id }) => api.clips.remove(id).then(() => forget(id)),
});
