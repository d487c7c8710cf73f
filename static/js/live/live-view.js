// The live view: a camera, or a clip played as if live, and what is recognised in it.

import { drawTrouble, startCamera } from "../camera/camera.js";
import { mirror } from "../camera/mirror.js";
import { drawSeen, overlay } from "../camera/pose-overlay.js";
import { countDown, record } from "../camera/recording.js";
import { takeEnd } from "../camera/take-end.js";
import { cameraPossible, offerCameras, release, showClip } from "../camera/video-source.js";
import { watch } from "../camera/watching.js";
import { select } from "../clips/clip-store.js";
import * as api from "../core/api.js";
import { byId, h } from "../core/dom.js";
import { bind } from "../core/key-bindings.js";
import { follow, state, update } from "../core/state.js";
import { toast } from "../core/toasts.js";
import { go } from "../core/views.js";
import { render } from "../templates.js";
import { addFiles } from "../upload/upload-list.js";
import { panel } from "./live-layout.js";
import { addResult, clearResults, showNothingRecognised } from "./live-results.js";
import { drawSpeed, drawState, nameTrigger } from "./live-status.js";

/** @import { Clip } from "../core/types.d.ts" */
/** @import { Listening, Recognized, Seen, Trouble } from "../camera/live-messages.d.ts" */

const COUNT = 3; // s: from the button to where the diver stands.
const INSTEAD = "play a clip as if live";
const FIRST = "Nothing recognised yet. What is recognised appears here.";

const BETWEEN = {
  salute: "Between two salutes",
  pose: "Between two poses of the arms",
  gesture: "Between the gestures that begin and end a take",
  none: "Anywhere",
};

const LONGEST = 5 * 60 * 1000; // ms of one recording: a dozen gestures; memory is finite.

/** @type {ReturnType<typeof watch> | null} */
let link = null;
/** @type {SVGSVGElement | null} */
let drawing = null;
/** @type {ReturnType<typeof record> | null} */
let recording = null;
/** @type {AbortController | null} */
let counting = null;
let recognised = 0; // takes that were recognised since the source was started
/** @type {number | null} */
let rate = null; // frames recently processed per second

const video = () => byId("live-video");
const fromClip = () => state.source === "clip";
// The models find nobody in a drawn skeleton.
const pictured = () => state.clips.filter((clip) => clip.shows_pictures);
const chosenClip = () => pictured().find((clip) => clip.id === state.clip) ?? pictured()[0] ?? null;

/** @param {Trouble | null} trouble */
const problem = (trouble) => drawTrouble(byId("live-problem"), trouble, start);

/** Update the buttons to the current state. */
function drawControls() {
  const watching = link !== null;
  const begin = byId("live-start");
  begin.replaceChildren(watching ? "Stop" : fromClip() ? "Play as if live" : "Start the camera");
  begin.className = watching ? "" : "primary";
  begin.disabled = !watching && fromClip() && !chosenClip();
  const take = byId("live-record");
  take.hidden = fromClip();
  take.replaceChildren(
    h("i", { className: "dot", "aria-hidden": "true" }),
    recording ? "Stop recording" : counting ? "Cancel" : "Record a clip",
  );
  take.classList.toggle("recording", recording !== null);
  byId("live-clips").hidden = byId("live-every").parentElement.hidden = !fromClip();
  byId("live-autostop").parentElement.hidden = fromClip();
  byId("live-idle").hidden = watching;
  for (const name of ["camera", "clip"])
    byId(`live-from-${name}`).setAttribute(
      "aria-pressed",
      String((name === "clip") === fromClip()),
    );
}

function drawClipChoice() {
  const choice = byId("live-clips");
  const chosen = chosenClip();
  choice.replaceChildren(
    ...pictured().map((clip) =>
      h("option", { value: clip.id, selected: clip === chosen }, clip.name),
    ),
  );
  drawControls();
}

async function drawCameraChoice() {
  const choice = byId("live-cameras");
  await offerCameras(choice, video());
  choice.hidden ||= fromClip();
}

function stop() {
  link?.stop();
  counting?.abort();
  endRecording();
  release(video());
  link = null;
  drawing?.remove();
  drawState(null);
  drawSpeed(null, 0);
  drawControls();
}

/**
 * @param {Seen} answer
 * @param {number} seconds
 */
function seen(answer, seconds) {
  if (drawing) drawSeen(drawing, answer);
  drawState(answer);
  drawSpeed(answer, seconds);
  rate = answer.frames_per_second;
  end.seen(answer);
}

/**
 * Stop at the end of a clip, and say how many frames were processed if nothing was recognised.
 *
 * @param {Clip} clip
 */
function clipEnded(clip) {
  stop();
  if (!recognised) showNothingRecognised(clip, rate);
}

/** @param {string} reason */
function ended(reason) {
  stop();
  problem({ title: "The live view ended", text: reason });
}

/** @param {Listening} message */
function listening({ language, gestures, problem: trouble }) {
  const text = trouble
    ? `Takes are found, but none is recognised: ${trouble}.`
    : language
      ? `${BETWEEN[state.gestures?.trigger?.kind ?? "salute"]}: any of ${gestures === 1 ? "one gesture" : `${gestures} gestures`} of \u201c${language}\u201d.`
      : "Takes are found, but no language is chosen to recognise them.";
  byId("live-language").textContent = text;
}

/**
 * Show a clip, or the chosen camera.
 *
 * @param {Clip | null} clip
 * @returns {Promise<boolean>} whether there is a picture now
 */
async function showSource(clip) {
  const [picture, box] = [byId("live-picture"), byId("live-problem")];
  const options = {
    instead: INSTEAD,
    again: start,
    lost: stop,
    device: byId("live-cameras").value,
  };
  if (!clip) return startCamera({ video: video(), picture, box }, options);
  try {
    await showClip(video(), api.clips.video(clip));
  } catch (error) {
    release(video());
    problem({ title: "The clip cannot be played", text: error.message });
    return false;
  }
  mirror(picture, video());
  return true;
}

/** Show the camera or the clip, and begin to look at its frames. */
async function start() {
  stop();
  [recognised, rate] = [0, null];
  problem(null);
  const clip = fromClip() ? chosenClip() : null;
  const button = byId("live-start");
  button.disabled = true;
  const isShown = await showSource(clip);
  button.disabled = false;
  if (!isShown) {
    if (cameraPossible()) drawCameraChoice(); // The chosen camera may be gone.
    return false;
  }
  // The user may take long to allow the camera.
  if (state.view !== "live") {
    stop();
    return false;
  }
  drawing = overlay(video());
  const opened = watch(video(), {
    seen,
    listening,
    ended,
    recognized: (/** @type {Recognized} */ result) => {
      recognised += 1;
      end.recognized(result, state.gestures?.trigger?.kind ?? "salute");
      addResult(result, clip);
    },
  });
  link = opened;
  link.listen(state.language);
  drawControls();
  if (!clip) drawCameraChoice();
  await opened.opened;
  if (link !== opened) return false;
  const every = clip && byId("live-every").checked;
  video().onended = () => {
    if (clip) clipEnded(clip);
  };
  if (clip) video().onerror = () => ended("The clip broke off: the server did not answer.");
  opened.begin(Boolean(every));
  if (clip && !every) await video().play();
  return true;
}

/** @param {number | null} left */
function showCount(left) {
  const box = byId("live-count");
  box.hidden = left === null;
  box.textContent = left === null ? "" : String(left);
}

async function beginRecording() {
  if (!link && !(await start())) return;
  counting = new AbortController();
  drawControls();
  const whole = await countDown(COUNT, showCount, counting.signal);
  counting = null;
  if (whole && video().srcObject) {
    recording = record(video().srcObject);
    setTimeout(
      (/** @type {typeof recording} */ it) => {
        if (recording === it) endRecording();
      },
      LONGEST,
      recording,
    );
  }
  byId("live-picture").classList.toggle("recording", recording !== null);
  drawControls();
}

const end = takeEnd(() => byId("live-autostop").checked && endRecording());

async function endRecording() {
  end.reset();
  const ended = recording;
  if (!ended) return;
  recording = null;
  byId("live-picture").classList.remove("recording");
  drawControls();
  const file = await ended.stop();
  if (!file) return;
  addFiles([file]);
  toast("Clip recorded", `${file.name} is read for poses now.`, {
    action: { label: "Show it", run: () => go("studio") },
  });
}

const toggle = () => (link ? stop() : start());
const toggleRecording = () =>
  recording ? endRecording() : counting ? counting.abort() : beginRecording();

/**
 * Choose between camera and clip.
 *
 * @param {"clip" | null} source
 */
function chooseSource(source) {
  stop();
  problem(null);
  update({ source });
}

function wire() {
  byId("live-start").onclick = toggle;
  byId("live-record").onclick = toggleRecording;
  byId("live-from-camera").onclick = () => chooseSource(null);
  byId("live-from-clip").onclick = () => chooseSource("clip");
  byId("live-cameras").onchange = start;
  byId("live-clips").onchange = () => {
    stop();
    select(byId("live-clips").value);
  };
  byId("live-clear").onclick = () => clearResults(FIRST);
}

const when = () => state.view === "live";
bind({ keys: ["Space"], text: "Start or stop watching", group: "Live", run: toggle, when });
bind({
  keys: ["R"],
  text: "Record a clip from the camera, or stop",
  group: "Live",
  run: () => {
    if (!fromClip() && !byId("live-record").disabled) toggleRecording();
  },
  when,
});

/**
 * Called once, when the view is first shown.
 *
 * @param {HTMLElement} section
 */
export function open(section) {
  render(panel(), section);
  clearResults(FIRST);
  wire();
  follow(["clips", "clip", "source"], drawClipChoice);
  follow(["language"], ({ language }) => link?.listen(language));
  follow(["gestures"], () => {
    nameTrigger();
    if (!link) drawState(null);
  });
  follow(["view"], ({ view }) => {
    if (view !== "live") stop();
  });
  addEventListener("pagehide", stop);
  navigator.mediaDevices?.addEventListener("devicechange", drawCameraChoice);
  drawState(null);
  drawSpeed(null, 0);
}
