// The panel in the middle while there is nothing to show: how to begin, or the progress.

import { BUSY } from "../clips/batch.js";
import { needsTopic, select, statusText } from "../clips/clip-store.js";
import { addSampleClip, samplesList } from "../clips/sample-clips.js";
import { topicsPanel } from "../clips/topic-dialog.js";
import * as api from "../core/api.js";
import { byId, h } from "../core/dom.js";
import { showFrames } from "../clips/frame-times.js";
import { drawPose, skeleton } from "../clips/skeleton.js";
import { mayWrite } from "../core/session.js";
import { isReadable, selectedClip, state, update, whenLoaded } from "../core/state.js";
import { toast } from "../core/toasts.js";
import { go } from "../core/views.js";
import { choose, knowsSampleClips, MISREAD } from "../languages/language-store.js";
import { buttonOf, elementOf, html, iconOf, nothing } from "../templates.js";

/** @import { Clip, Job, LanguageSummary, Sample, State } from "../core/types.d.ts" */

/** @typedef {{ sample: Sample, language: LanguageSummary }} Example */

const STEPS = [
  ["Show", "Add a clip of a diver: salute, gesture, salute."],
  ["Save", "Save the take, what lies between the salutes, as a gesture."],
  ["Ask why", "Recognise another clip, and see what differs and what helps."],
  ["Export", "Export the language for the robot as one file."],
];

const FILM = new URL("../../first-take.mp4", import.meta.url).href; // made by languages/first_take.py
const END = "#t=3.2"; // s: the drawing and its name are shown

/**
 * A few clips to begin with, one of each kind; the library lists all. Clips to recognise come
 * first, since the sample languages already contain the demonstrations.
 *
 * @param {Sample[]} samples
 */
function offered(samples) {
  /** @param {Sample} sample */
  const demonstrates = (sample) => sample.name.includes("demonstration");
  const sorted = [...samples].sort(
    (one, other) => Number(demonstrates(one)) - Number(demonstrates(other)),
  );
  const kinds = new Map();
  for (const sample of sorted) {
    const kind = sample.name.split("-")[0];
    if (!kinds.has(kind)) kinds.set(kind, sample);
  }
  return [...kinds.values()];
}

/** A take, for people who have never seen one; who wants no motion sees its end, until a click. */
function firstTake() {
  const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
  const film = h("video", {
    muted: true,
    loop: true,
    autoplay: !still,
    playsInline: true,
    preload: "auto",
    "aria-hidden": "true",
    src: still ? FILM + END : FILM,
    // A browser without H.264 shows the drawing of the salute alone.
    onerror: () => film.closest("button")?.remove(),
  });
  const turn = () => (film.paused ? film.play() : film.pause());
  return html`<figure class="first-take">
    ${buttonOf(film, turn, {
      title: "Play or pause",
      label: "Film: a circle between two Vulcan salutes becomes a gesture. Play or pause",
    })}
    <figcaption>
      ${iconOf("salute")}<span
        ><b>Vulcan salute: </b>palm forward, fingers parted two by two, held for half a
        second.</span
      >
    </figcaption>
  </figure>`;
}

/**
 * A button that opens the explanation of the misread sample; null if it or its language is gone.
 *
 * @param {Sample[]} samples
 * @param {LanguageSummary[]} languages
 */
function question(samples, languages) {
  const found = exampleOf(samples, languages);
  if (!found) return nothing;
  const able = mayWrite() || knownClip(found.sample);
  return html`<button
      type="button"
      class="question"
      ?disabled=${!able}
      @click=${(/** @type {any} */ { currentTarget }) => ask(found, currentTarget)}
    >
      <b>Why was a ${MISREAD.expected} read as a ${MISREAD.read}?</b
      ><span
        >This sample clip is recognised wrongly. See what differs, where, and what would have
        helped.</span
      >
    </button>
    ${able ? nothing : html`<p class="dim">${EXAMPLE_NEEDS_EDIT}</p>`}`;
}

/** Why a reader sees no example, and who can help. */
const EXAMPLE_NEEDS_EDIT =
  "The example\u2019s clip is not in this studio yet, and your token has the role read. Ask someone whose token has the role edit to open the example once; then you can open it too.";

/** @param {Sample} sample */
const knownClip = (sample) =>
  state.clips.find(({ name, status }) => name === sample.name && status === "done");

/**
 * The misread sample and a language that misreads it; null where one of them is gone.
 *
 * @param {Sample[]} samples
 * @param {LanguageSummary[]} languages
 * @returns {Example | null}
 */
function exampleOf(samples, languages) {
  const sample = samples.find(({ name }) => name === MISREAD.name);
  const able = languages.filter(knowsSampleClips);
  const language = able.find(({ id }) => id === state.language) ?? able[0];
  return sample && language ? { sample, language } : null;
}

/**
 * @param {Example} example
 * @param {HTMLButtonElement} button
 */
async function ask({ sample, language }, button) {
  await choose(language.id);
  const known = knownClip(sample);
  if (known) select(known.id);
  const clip = known?.id ?? (await addSampleClip(sample, button));
  if (clip) update({ question: { clip, expected: MISREAD.expected } });
}

/** Show the misread sample, from any view. */
export async function showExample() {
  await whenLoaded();
  const found = exampleOf(state.samples, state.languages);
  if (!found) {
    toast("There is no example", "Its sample clip or its sample language was deleted.");
    return;
  }
  if (!mayWrite() && !knownClip(found.sample)) {
    toast("The example needs the role edit", EXAMPLE_NEEDS_EDIT);
    return;
  }
  await go("studio");
  await ask(found, h("button"));
}

/**
 * @param {Sample[]} samples
 * @param {LanguageSummary[]} languages
 */
const welcome = (samples, languages) =>
  html`<div>
    <h1>One demonstration makes a gesture</h1>
    ${firstTake()}
    <ol class="steps">
      ${STEPS.map(([title, text]) => html`<li><b>${title}</b><span>${text}</span></li>`)}
    </ol>
    ${question(samples, languages)}
    <div class="welcome-actions">
      <button type="button" class="primary" data-writes @click=${() => byId("file").click()}>
        Choose clips
      </button>
      ${samples.length ? html`<span class="dim">or begin with a sample:</span>` : nothing}
    </div>
    ${samples.length ? samplesList(offered(samples)) : nothing}
  </div>`;

/** The panel after the clip on display was deleted elsewhere. */
const noClip = () =>
  elementOf(
    html`<div class="welcome-none">
      <h1>No clip is shown</h1>
      <p class="dim">Choose one from the list, or drop another one.</p>
    </div>`,
  );

/** @type {ReturnType<typeof showFrames> | null} */
let frames = null; // of the clip whose progress is shown

/**
 * The clip's own picture under the skeleton; `showProgress` updates both.
 *
 * @param {Clip} clip
 */
function progressPanel(clip) {
  // The video of a dive recording, or of turned pictures, is made while its poses are found.
  const video =
    clip.topics.length || clip.turn
      ? null
      : h("video", {
          muted: true,
          playsInline: true,
          preload: "auto",
          "aria-hidden": "true",
        });
  frames = video && showFrames(video);
  frames?.load(api.clips.video(clip));
  return elementOf(
    html`<div class="welcome-progress">
      <div class="live-pose" .style=${`aspect-ratio: ${clip.width} / ${clip.height}`}>
        ${video}${skeleton(clip.width, clip.height)}
      </div>
      <h1></h1>
      <progress aria-label="Progress"></progress>
      <p class="dim" role="status"></p>
    </div>`,
  );
}

/**
 * Show the frame in which the newest pose was found, and the pose.
 *
 * @param {HTMLElement} panel
 * @param {Clip} clip
 * @param {Job} job
 */
function showPose(panel, clip, { time, pose }) {
  const video = panel.querySelector("video");
  const playable =
    video &&
    !video.error &&
    (video.videoWidth || video.readyState === HTMLMediaElement.HAVE_NOTHING);
  if (video && !playable) video.replaceWith(h("img", { src: api.clips.poster(clip), alt: "" }));
  const skeletonDrawing = /** @type {SVGSVGElement} */ (panel.querySelector(".skeleton"));
  if (!frames || !playable || time === null) return drawPose(skeletonDrawing, pose);
  return frames.show({ begin: time, shown: () => drawPose(skeletonDrawing, pose) });
}

/**
 * Update the moving parts of the panel, and keep the rest, so that the video is not reloaded.
 *
 * @param {HTMLElement} panel
 * @param {Clip} clip
 * @param {Job | undefined} job
 */
function showProgress(panel, clip, job) {
  const bar = panel.querySelector("progress");
  const [title, status] = ["h1", "[role=status]"].map((each) => panel.querySelector(each));
  if (!bar || !title || !status) return;
  title.textContent =
    clip.status === "queued" ? "Waiting in the queue" : "Finding the diver\u2019s poses";
  status.textContent = statusText(clip, job);
  if (job?.total) Object.assign(bar, { max: job.total, value: job.done });
  else bar.removeAttribute("value");
  if (job && job.time !== null) showPose(panel, clip, job);
}

/**
 * Whether a clip has nothing to show but its progress.
 *
 * @param {Clip} clip
 */
const isBeingRead = (clip) => BUSY.has(clip.status) && !isReadable();

/**
 * The panel as `{ key, panel }`, or null when the workspace has something to show.
 *
 * @param {State} state
 * @param {Clip | null} clip
 */
function contentOf({ clips, uploads, samples, languages, loaded, role }, clip) {
  if (clip && isBeingRead(clip)) return { key: clip.job_id, panel: () => progressPanel(clip) };
  if (clip && needsTopic(clip)) return { key: `topics ${clip.id}`, panel: () => topicsPanel(clip) };
  if (clip || !loaded || uploads.length) return null;
  if (clips.length) return { key: "unchosen", panel: noClip };
  const revisions = languages.map(({ id, revision }) => id + revision);
  return {
    key: `welcome ${samples.length} ${revisions} ${role}`,
    panel: () => elementOf(welcome(samples, languages)),
  };
}

/**
 * Draw the panel, or hide it when the workspace has something to show.
 *
 * @param {State} values
 */
export function drawWelcome(values) {
  const box = byId("welcome");
  const clip = selectedClip();
  const content = contentOf(values, clip);
  const key = content?.key ?? "";
  box.hidden = !key;
  if (box.dataset.shows !== key) {
    box.dataset.shows = key;
    box.replaceChildren(...(content ? [content.panel()] : []));
  }
  if (clip && isBeingRead(clip)) showProgress(box, clip, values.jobs.get(clip.job_id));
}
