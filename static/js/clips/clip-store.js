// The clips as the server has them: loading, selecting, and the progress of finding their poses.

import * as api from "../core/api.js";
import { dateAndTime, duration, plural, timeLeft } from "../core/format.js";
import { h } from "../core/dom.js";
import { refresh } from "../core/list-refresh.js";
import { placeIn, state, update } from "../core/state.js";
import { registerUndo } from "../core/undo.js";
import { placeInQueue } from "./batch-card.js";
import { forget, newestFirst, take } from "./clip-pages.js";
import { BUSY } from "./batch.js";

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
    list: "clips",
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
  update(placeIn(id));
}

/**
 * Show a clip that the user did not choose: an upload that ends may replace it.
 *
 * @param {string | null} id
 */
export function offer(id) {
  select(id);
  update({ offered: id });
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
 * Names that several clips have, by the list of clips.
 *
 * @type {WeakMap<Clip[], Set<string>>}
 */
const shared = new WeakMap();

/**
 * When a clip was added, where another one has its name; else "".
 *
 * @param {Clip} clip
 * @param {Clip[]} clips
 */
export function addedAt(clip, clips = state.clips) {
  if (!shared.has(clips)) {
    const names = clips.map(({ name }) => name).sort();
    shared.set(clips, new Set(names.filter((name, at) => name === names[at - 1])));
  }
  if (!shared.get(clips)?.has(clip.name)) return "";
  const added = new Date(clip.created);
  const today = added.toDateString() === new Date().toDateString();
  // Clips of one minute differ in the seconds.
  return `added ${today ? added.toLocaleTimeString() : dateAndTime(clip.created)}`;
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
  const added = addedAt(clip);
  if (BUSY.has(clip.status))
    return added ? `${progressText(clip, job)} \u00b7 ${added}` : progressText(clip, job);
  return [
    clip.duration ? duration(clip.duration) : null,
    clip.frames ? plural(clip.frames, "frame") : null,
    added,
  ]
    .filter(Boolean)
    .join(" \u00b7 ");
}

/**
 * Whether a clip has a still picture: a received video from the beginning, anything else once its
 * job has made one.
 *
 * @param {Clip} clip
 */
export function hasPoster(clip) {
  if (clip.shows_pictures && !clip.topics.length && !clip.turn) return true;
  return clip.status === "running"
    ? Boolean(state.jobs.get(clip.job_id)?.done)
    : clip.status !== "queued" && clip.status !== "cancelled";
}

/**
 * The picture of a clip, or a grey box.
 *
 * @param {Clip} clip
 */
export function posterOf(clip) {
  const place = api.clips.poster(clip);
  if (!hasPoster(clip)) return h("div", { className: "poster blank" });
  const poster = h("img", {
    className: "poster",
    // Another address than later, because a browser keeps pictures for an hour.
    src: clip.status === "queued" ? `${place}?waiting` : place,
    alt: "",
    loading: "lazy",
    width: 64,
    height: 48,
  });
  poster.onerror = () => poster.replaceWith(h("div", { className: "poster blank" }));
  return poster;
}

registerUndo("clip", {
  undo: ({ id }) =>
    api.clips
      .restore(id)
      .then(take)
      .then(() => select(id)),
  redo: ({ id }) => api.clips.remove(id).then(() => forget(id)),
});
