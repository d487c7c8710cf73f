// The card above the clips while several wait: how many are done, which one runs, the time left.

import { tabStore } from "../core/browser-store.js";
import { byId } from "../core/dom.js";
import { about, plural } from "../core/format.js";
import { html, nothing, progressBar, render } from "../templates.js";
import { BUSY, follow, queueOf, secondsLeft } from "./batch.js";

/** @import { Batch, Clip, Job, State } from "../core/types.d.ts" */

const KEY = "osg-studio.queue"; // Clips of the batch, whose count a reload keeps

/** @type {Batch | null | undefined} */
let batch; // undefined before the first drawing after a load of the page

/** @returns {Batch | null} */
function kept() {
  const members = tabStore.read(KEY);
  return members && { members, began: null, frames: 0, left: 0, at: 0 };
}

/**
 * What the card says; null where at most one clip is busy.
 *
 * @param {Batch} current
 * @param {Clip[]} clips
 * @param {Map<string, Job>} jobs
 */
function wordsOf(current, clips, jobs) {
  const known = clips.filter(({ id }) => current.members.includes(id));
  const done = known.filter(({ status }) => !BUSY.has(status)).length;
  const left = secondsLeft(current);
  const running = known.find(({ status }) => status === "running");
  const job = running && jobs.get(running.job_id);
  return {
    total: known.length,
    done,
    title: `${done} of ${plural(known.length, "clip")} done${left === null ? "" : `, ${about(left)} left`}`,
    now: running
      ? `${running.name}${job?.total ? `: ${job.done} of ${job.total} frames` : ""}`
      : "",
  };
}

/** @param {State} state */
export function drawBatch({ clips, jobs, loaded }) {
  const box = byId("batch");
  if (!loaded && !clips.length) return undefined; // The clips are not known yet.
  batch = follow(batch === undefined ? kept() : batch, clips, jobs, performance.now());
  tabStore.write(KEY, batch?.members ?? null);
  box.hidden = !batch || batch.members.length < 2;
  if (!batch || box.hidden) return render(nothing, box);
  const { total, done, title, now } = wordsOf(batch, clips, jobs);
  const { frames, left } = batch;
  return render(
    html`<b role="status">${title}</b>
      ${progressBar("Progress of all clips", frames || done, frames + left || total)}
      <span class="dim">${now}</span>`,
    box,
  );
}

/**
 * The place of a waiting clip in the queue, in words.
 *
 * @param {Clip[]} clips
 * @param {Clip} clip
 */
export function placeInQueue(clips, clip) {
  const queue = queueOf(clips);
  const place = queue.findIndex(({ id }) => id === clip.id) + 1;
  if (!place) return "Waiting in the queue";
  return place === 1 ? "Next in the queue" : `Number ${place} of ${queue.length} in the queue`;
}
