// The live view: a camera, or a clip played as if live, and what is recognised in it.

import { makeCamera } from "../camera/camera.js";
import { select } from "../clips/clip-store.js";
import { olderClipsButton } from "../clips/older-clips.js";
import { endName, saluteHand } from "../clips/salutes.js";
import * as api from "../core/api.js";
import { bind } from "../core/key-bindings.js";
import { mayWrite } from "../core/session.js";
import { follow, state, update } from "../core/state.js";
import { toast } from "../core/toasts.js";
import { go } from "../core/views.js";
import { buttonOf, guard, html, optionsOf, render } from "../templates.js";
import { addFiles } from "../upload/upload-list.js";
import { listOf, newestOf } from "./live-results.js";
import { speedOf, stepsOf } from "./live-status.js";

/** @import { Listening, Seen } from "../camera/live-messages.d.ts" */
/** @import { Recording } from "../camera/recording.js" */
/** @import { Clip } from "../core/types.d.ts" */
/** @import { Result } from "./live-results.js" */

const COUNT = 3; // s: from the button to where the diver stands.
const FIRST = "Nothing recognised yet. What is recognised appears here.";
const LONGEST = 5 * 60 * 1000; // ms of one recording: a dozen gestures; memory is finite.
const MOST = 50; // recognitions in the list; a practice session has fewer.

const BETWEEN = {
  salute: "Between two salutes",
  pose: "Between two poses of the arms",
  gesture: "Between the gestures that begin and end a take",
  none: "Anywhere",
};

/** What is drawn, with the camera and the state of the page; `told` stands in place of a result. */
const now = {
  seen: /** @type {Seen | null} */ (null),
  seconds: 0, // from the capture of what was seen
  rate: /** @type {number | null} */ (null), // frames recently processed per second
  recognised: 0, // takes since the source was started
  results: /** @type {Result[]} */ ([]),
  told: FIRST,
  language: "",
  counting: /** @type {AbortController | null} */ (null),
  recording: /** @type {Recording | null} */ (null),
  every: false,
  autostop: true,
};

/** @type {HTMLElement | null} */
let root = null;

const camera = makeCamera({ instead: "play a clip as if live", draw, start, stop });
const hand = saluteHand();
const olderClips = olderClipsButton();

const kind = () => state.gestures?.trigger?.kind ?? "salute";
const fromClip = () => state.source === "clip";
// The models find nobody in a drawn skeleton.
const pictured = () => state.clips.filter((clip) => clip.shows_pictures);
const chosenClip = () => pictured().find((clip) => clip.id === state.clip) ?? pictured()[0] ?? null;

/** @param {Partial<typeof now>} change */
function put(change) {
  Object.assign(now, change);
  draw();
}

function stop() {
  now.counting?.abort();
  endRecording();
  now.seen = null;
  camera.off();
}

/**
 * Stop at the end of a clip, and say how many frames were processed if nothing was recognised.
 *
 * @param {Clip} clip
 */
function clipEnded(clip) {
  stop();
  if (now.recognised) return;
  const looked =
    now.rate === null
      ? "No frame of it could be looked at in time"
      : `${now.rate.toFixed(1)} frames a second of it were looked at`;
  put({
    told: `Nothing was recognised in ${clip.name}. ${looked}; tick \u201cEvery frame\u201d and play it again to miss none.`,
  });
}

/** @param {string} text */
function ended(text) {
  stop();
  camera.put({ trouble: { title: "The live view ended", text } });
}

/** @param {Listening} message */
function listening({ language, gestures, problem: trouble }) {
  const text = trouble
    ? `Takes are found, but none is recognised: ${trouble}.`
    : language
      ? `${BETWEEN[kind()]}: any of ${gestures === 1 ? "one gesture" : `${gestures} gestures`} of \u201c${language}\u201d.`
      : "Takes are found, but no language is chosen to recognise them.";
  put({ language: text });
}

/** Show the camera or the clip, and begin to look at its frames. */
async function start() {
  stop();
  Object.assign(now, { recognised: 0, rate: null });
  const clip = fromClip() ? chosenClip() : null;
  if (!(await camera.show(clip && api.clips.video(clip)))) return false;
  // The user may take long to allow the camera.
  if (state.view !== "live") {
    stop();
    return false;
  }
  camera.overlay();
  const opened = camera.watch({
    kind,
    listening,
    ended,
    taken: () => now.autostop && endRecording(),
    seen: (seen, seconds) => put({ seen, seconds, rate: seen.frames_per_second }),
    recognized: (result) => {
      const newest = { result, clip, clock: new Date().toLocaleTimeString() };
      const results = [newest, ...now.results].slice(0, MOST);
      put({ results, told: "", recognised: now.recognised + 1 });
    },
  });
  camera.listen(state.language);
  await opened.opened;
  if (!opened.goesOn()) return false;
  const { video } = camera;
  const every = clip !== null && now.every;
  if (clip) {
    video.onended = () => clipEnded(clip);
    video.onerror = () => ended("The clip broke off: the server did not answer.");
  }
  opened.begin(every);
  if (clip && !every) await video.play();
  return true;
}

async function beginRecording() {
  if (!camera.shown.on && !(await start())) return;
  const counting = new AbortController();
  put({ counting });
  const whole = await camera.countDown(COUNT, counting.signal);
  const recording = whole ? camera.record() : null;
  Object.assign(now, { counting: null, recording });
  camera.put({ recording: recording !== null });
  if (recording) setTimeout(() => now.recording === recording && endRecording(), LONGEST);
}

async function endRecording() {
  camera.reset();
  const { recording } = now;
  if (!recording) return;
  now.recording = null;
  camera.put({ recording: false });
  const file = await recording.stop();
  if (!file) return;
  addFiles([file]);
  toast("Clip recorded", `${file.name} is read for poses now.`, {
    action: { label: "Show it", run: () => go("studio") },
  });
}

const toggle = () => (camera.shown.on ? stop() : start());
const toggleRecording = () =>
  now.recording ? endRecording() : now.counting ? now.counting.abort() : beginRecording();

/**
 * Choose between camera and clip.
 *
 * @param {"clip" | null} source
 */
function chooseSource(source) {
  stop();
  camera.put({ trouble: null });
  update({ source });
}

/**
 * @param {"every" | "autostop"} name
 * @param {string} text
 * @param {string} title
 */
const check = (name, text, title) =>
  html`<label class="check" title=${title}
    ><input
      type="checkbox"
      .checked=${now[name]}
      @change=${(/** @type {any} */ { target }) => put({ [name]: target.checked })}
    /><span>${text}</span></label
  >`;

/** The choice among the clips, drawn only when they change: frames come many times a second. */
function clipChoice() {
  const choose = (/** @type {any} */ { target }) => {
    stop();
    select(target.value);
  };
  const clips = pictured();
  const chosen = chosenClip()?.id ?? "";
  return html`<select aria-label="Clip" @change=${choose}>
      ${guard([state.clips, chosen], () =>
        optionsOf(
          clips.map(({ id, name }) => [id, name]),
          chosen,
        ),
      )}</select
    >${check(
      "every",
      "Every frame",
      "Processes every frame, also when this machine is slower than the clip",
    )}`;
}

/** The choice among the cameras, and what is recorded from them. */
const cameraChoice = () =>
  html`${camera.choice()}${check(
    "autostop",
    `Stop after the closing ${endName(state.gestures)}`,
    "Ends a recording when a take ends, without a click",
  )}`;

function controls() {
  const { on, busy } = camera.shown;
  const source = (/** @type {"clip" | null} */ name, /** @type {string} */ text) =>
    buttonOf(text, () => chooseSource(name), { pressed: (name === "clip") === fromClip() });
  const words = now.recording ? "Stop recording" : now.counting ? "Cancel" : "Record a clip";
  return html`<div class="live-controls">
    <div class="segments" role="group" aria-label="Source">
      ${source(null, "Camera")}${source("clip", "Clip")}
    </div>
    ${fromClip() ? clipChoice() : cameraChoice()}${olderClips}
    <span class="spacer"></span>
    <button
      type="button"
      class="live-record ${now.recording ? "recording" : ""}"
      data-writes
      title="Record a clip, after a countdown (R)"
      ?hidden=${fromClip()}
      @click=${toggleRecording}
    >
      <i class="dot" aria-hidden="true"></i>${words}
    </button>
    ${buttonOf(on ? "Stop" : fromClip() ? "Play as if live" : "Start the camera", toggle, {
      look: on ? "" : "primary",
      title: "Start or stop watching (Space)",
      disabled: busy || (!on && fromClip() && !chosenClip()),
    })}
  </div>`;
}

function draw() {
  if (!root) return;
  const { seen, seconds, results, told, language, every } = now;
  const idle = html`${hand}No source is running`;
  render(
    html`<section class="live-stage" aria-label="Live picture">
        <h1>Live recognition</h1>
        ${camera.picture({ idle })}${stepsOf(seen, kind())}${controls()}
      </section>
      <aside class="live-side" aria-label="Recognised live">
        ${newestOf(results, told)}
        <p class="dim">${language}</p>
        <div class="live-head" ?hidden=${!results.length}>
          <h2>Recognised</h2>
          ${buttonOf("Clear", () => put({ results: [], told: FIRST }), { look: "link" })}
        </div>
        ${listOf(results)}${speedOf(seen, seconds, fromClip() && every)}
      </aside>`,
    root,
  );
}

const when = () => state.view === "live";
bind({ keys: ["Space"], text: "Start or stop watching", group: "Live", run: toggle, when });
bind({
  keys: ["R"],
  text: "Record a clip from the camera, or stop",
  group: "Live",
  run: () => !fromClip() && mayWrite() && toggleRecording(),
  when,
});

/**
 * Called once, when the view is first shown.
 *
 * @param {HTMLElement} section
 */
export function open(section) {
  root = section;
  follow(["clips", "clip", "source", "gestures"], draw);
  follow(["language"], ({ language }) => camera.listen(language));
  follow(["view"], ({ view }) => {
    if (view !== "live") stop();
  });
}
