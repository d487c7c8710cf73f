// What stands in the middle while there is nothing to show yet: the way to begin, or the progress.

import * as api from "./api.js";
import { BUSY, samplesList, statusText } from "./clips.js";
import { byId, h } from "./dom.js";
import { selectedClip } from "./state.js";

const STEPS = [
  ["Show", "Drop a clip of a diver: Vulcan salute, the gesture, Vulcan salute."],
  ["Save", "Save the take between the salutes as a gesture. One demonstration is enough."],
  ["Ask why", "Recognise another clip, and see every voter\u2019s distance to every gesture."],
  ["Export", "Give the language to the robot as one JSON file."],
];

/**
 * A few clips to begin with, one of each kind; all of them are in the library. Those to recognise
 * come first, since the sample languages hold the demonstrations already.
 */
function offered(samples) {
  const demonstrates = (sample) => sample.name.includes("demonstration");
  const sorted = [...samples].sort((one, other) => demonstrates(one) - demonstrates(other));
  const kinds = new Map();
  for (const sample of sorted) {
    const kind = sample.name.split("-")[0];
    if (!kinds.has(kind)) kinds.set(kind, sample);
  }
  return [...kinds.values()];
}

function welcome(samples) {
  return [
    h("h1", {}, "One demonstration makes a gesture"),
    h("ol", { className: "steps" }, STEPS.map(([title, text]) => h("li", {}, h("b", {}, title), h("span", {}, text)))),
    h("div", { className: "welcome-actions" },
      h("button", { type: "button", className: "primary", onclick: () => byId("file").click() }, "Choose clips"),
      samples.length ? h("span", { className: "dim" }, "or begin with a sample:") : null),
    samples.length ? samplesList(offered(samples)) : null,
  ];
}

function progressOf(clip, job) {
  const bar = h("progress", { "aria-label": "Progress", ...(job?.total ? { max: job.total, value: job.done } : {}) });
  const poster = h("img", { className: "welcome-poster", src: api.clips.poster(clip.id), alt: "" });
  poster.onerror = () => poster.remove(); // There is none before the clip's first frame was read.
  return [
    poster,
    h("h1", {}, clip.status === "queued" ? "Waiting for its turn" : "Finding the diver\u2019s poses"),
    bar,
    h("p", { className: "dim", role: "status" }, statusText(clip, job)),
  ];
}

/** Draw it, or hide it when the frame has something to show. */
export function drawWelcome({ clips, uploads, samples, jobs, loaded }) {
  const box = byId("welcome");
  const clip = selectedClip();
  const busy = clip && BUSY.has(clip.status);
  const nothing = loaded && !clips.length && !uploads.length;
  box.hidden = !busy && !nothing;
  if (nothing && box.dataset.shows !== `welcome ${samples.length}`) {
    box.dataset.shows = `welcome ${samples.length}`;
    box.replaceChildren(h("div", {}, welcome(samples)));
  }
  if (!busy) return;
  const job = jobs.get(clip.job_id);
  const bar = box.querySelector("progress");
  if (box.dataset.shows === `${clip.id} ${clip.status}` && job?.total && bar.max === job.total) {
    // Moving the bar rather than replacing it keeps its transition and the picture.
    bar.value = job.done;
    box.querySelector("[role=status]").textContent = statusText(clip, job);
    return;
  }
  box.dataset.shows = `${clip.id} ${clip.status}`;
  box.replaceChildren(h("div", { className: "welcome-progress" }, progressOf(clip, job)));
}
