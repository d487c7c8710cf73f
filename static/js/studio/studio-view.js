// The studio view: the clip on display, its takes, and the outcome of its recognition.

import { demonstratedBy } from "../clips/demonstration-ranges.js";
import { listWarnings, takesLanguage } from "../clips/salutes.js";
import { reloadClip } from "../clips/clip-store.js";
import * as api from "../core/api.js";
import { closeDialog } from "../core/dialogs.js";
import { byId, disableDuring } from "../core/dom.js";
import { askWhich, percent } from "../core/format.js";
import { isReadable, selectedClip, selectedRange, state, update } from "../core/state.js";
import { attempt, complain, toast } from "../core/toasts.js";
import { go } from "../core/views.js";
import { newLanguage } from "../languages/language-store.js";
import { expectation, expectedOf, NONE } from "../languages/test-set.js";
import { elementOf, html, nothing, render } from "../templates.js";
import { buildRanges } from "./labelled-ranges.js";
import { frameShown, keepsFrame } from "./playback.js";
import { byDistance } from "./vote-order.js";
import { supportOf } from "./vote-support.js";
import { drawTimeline } from "./timeline.js";
import { enlargePicture } from "./clip-picture.js";
import { bindTransport } from "./transport.js";
import { show } from "./workspace.js";

/** @import { Clip, Recognition, SelectedRange, State, Take, Timeline } from "../core/types.d.ts" */

const SETTLED = 250; // ms without a move of the range's handles before the scene is built anew.

let viewTimer = 0;
let asking = 0; // Counts the requests for takes.
let shownView = "";

/**
 * Load the takes of the clip on display; while its frames are being read, those that have ended.
 */
export async function loadTakes() {
  const clip = selectedClip();
  asking += 1;
  const mine = asking;
  const soFar = clip?.status === "running" && Boolean(state.jobs.get(clip.job_id)?.kept);
  if (!clip || (clip.status !== "done" && !soFar)) return update({ takes: null, timeline: null });
  const loaded = await (soFar
    ? takesOf(clip, true).catch(() => null) // Frames that another server reads are not here yet.
    : attempt("Loading the takes", () => takesOf(clip, false)));
  // An answer for the previous trigger may arrive last.
  if (!loaded || mine !== asking) return undefined;
  return keepTakes(...loaded, soFar);
}

/**
 * @param {Clip} clip
 * @param {boolean} soFar
 */
function takesOf(clip, soFar) {
  const by = takesLanguage(state.gestures);
  return Promise.all([api.clips.takes(clip.id, by, soFar), api.clips.timeline(clip.id, by, soFar)]);
}

/**
 * @param {Take[]} takes
 * @param {Timeline} timeline
 * @param {boolean} soFar
 */
function keepTakes(takes, timeline, soFar) {
  if (soFar && !takes.length) return undefined;
  shownView = ""; // What was shown may have been only the beginning.
  const kept = state.take !== null && state.take < takes.length ? state.take : null;
  const byHand = state.start !== null || state.end !== null;
  return update({ takes, timeline, take: kept ?? (takes.length && !byHand ? 0 : null) });
}

/** Show the selection in the workspace, once it has settled. */
export function showSelection() {
  clearTimeout(viewTimer);
  const clip = selectedClip();
  if (!clip || !isReadable() || !state.takes) return;
  const { shown } = /** @type {SelectedRange} */ (selectedRange());
  /** @type {{ clip_id: string, start?: number, end?: number, recognition_id?: string }} */
  const view = { clip_id: clip.id, start: shown[0], end: shown[1] };
  // Without a take or a range the whole clip is shown, to its very last frame.
  if (state.take === null && state.start === null) delete view.start;
  if (state.take === null && state.end === null) delete view.end;
  if (state.recognition) view.recognition_id = state.recognition;
  const text = JSON.stringify(view);
  if (text === shownView) return;
  viewTimer = setTimeout(
    () => {
      shownView = text;
      show({ ...view, keep_frame: keepsFrame() }).then(frameShown);
    },
    state.take === null && state.start !== null ? SETTLED : 0,
  );
}

/** The range on which the buttons act, as the API takes it. */
export function rangeOf() {
  const { start, end } = /** @type {SelectedRange} */ (selectedRange());
  const whole = state.take === null && state.start === null && state.end === null;
  return whole && !state.takes?.length
    ? { clip_id: state.clip }
    : { clip_id: state.clip, start, end };
}

/** @type {Set<string>} */
const intoSample = new Set(); // Sample languages into which the user chose to save.

/** Whether there is a language to save into; for a sample, a language of one's own is offered. */
async function hasLanguage() {
  const { gestures, language } = state;
  if (!language) return Boolean(await newLanguage());
  if (!gestures?.sample || intoSample.has(language)) return true;
  let sample = false;
  const save = () => {
    sample = true;
    intoSample.add(language);
    closeDialog();
  };
  const choice = elementOf(
    html`<button type="button" class="link" @click=${save}>
      Save into the sample “${gestures.name}” instead
    </button>`,
  );
  const made = await newLanguage({
    text: `\u201c${gestures.name}\u201d is a sample. Name a language of your own: the gesture is saved there.`,
    preview: choice,
  });
  return Boolean(made) || sample;
}

/** Make a gesture of what is selected, in its own view. */
async function saveGesture() {
  if (!(await hasLanguage())) return;
  await go("gesture", { gesture: null });
}

/**
 * Recognise what is selected; `extra` overrides parts of the request.
 *
 * @param {{ expected?: string | null } & Record<string, unknown>} extra
 */
export async function recogniseWith({ expected = byId("expected").value || null, ...extra } = {}) {
  /** @type {any} */
  const body = {
    ...rangeOf(),
    language_id: state.language,
    ...expectation(expected),
    ...extra,
  };
  const result = await attempt("Recognition", () => api.recognitions.create(body));
  if (!result || result.clip_id !== state.clip) return null; // Another clip is on display by now.
  update({ result, recognition: result.id });
  return result;
}

async function recognise() {
  if (!state.gestures?.gestures.length) {
    toast(
      "Nothing to compare with",
      "The language has no gestures yet. Save one from a take, or choose another language above.",
      { kind: "error" },
    );
    return;
  }
  update({ trial: null });
  await disableDuring(byId("recognise"), recogniseWith);
}

/**
 * Recognise a clip as requested, as soon as its takes are loaded.
 *
 * @param {State} state
 */
export async function answerQuestion({ question, takes, clip }) {
  if (!question || question.clip !== clip || !takes) return;
  update({ question: null });
  await recogniseWith({ expected: question.expected });
}

/** Load the recognition that the URL names. */
export async function loadResult() {
  const wanted = state.recognition;
  if (!wanted) return update({ result: null });
  if (state.result?.id === wanted) return undefined;
  try {
    const result = await api.recognitions.get(wanted);
    return state.recognition === wanted ? update({ result }) : undefined;
  } catch (error) {
    if (state.recognition !== wanted) return undefined;
    complain(error, "Loading the recognition");
    return update(api.isAway(error) ? { result: null } : { result: null, recognition: null });
  }
}

/**
 * Whether the take is the demonstration that has read it.
 *
 * @param {Recognition} result
 */
const isItself = (result) =>
  !result.without?.length && demonstratedBy(state.gestures?.gestures ?? [], result);

/**
 * By what the nearest gesture stands first in the table.
 *
 * @param {Recognition} result
 */
const rankWords = (result) =>
  byDistance(result)
    ? `distance ${result.scores[result.gestures.indexOf(result.nearest)]?.toFixed(2)}`
    : `${percent(supportOf(result).get(result.nearest) ?? 0)} of the votes`;

/**
 * The confidence, how the nearest gesture is ranked, and the trial.
 *
 * @param {Recognition} result
 */
const supportWords = (result) =>
  [
    isItself(result) ? "" : `confidence ${percent(result.confidence)}`,
    rankWords(result),
    result.pair && result.votes.second_opinion === result.pair[1]
      ? `the directions of the arms say ${result.pair[1]}`
      : "",
    isItself(result) ? "read by itself: the only demonstration cannot be tested" : "",
    result.without?.length ? "read without itself, a demonstration" : "",
    result.trial ? "on trial, not saved" : "",
  ]
    .filter(Boolean)
    .join(", ");

/**
 * What was recognised, in words.
 *
 * @param {Recognition} result
 */
function outcomeWords(result) {
  const { label, pair, nearest, fault } = result;
  const expected = expectedOf(result);
  const known = expected === null ? "" : ", as expected";
  const meant =
    expected === null || isRight(result)
      ? known
      : html`, expected <b class="expected">${expected}</b>`;
  if (pair) return html`<b class="chosen">${askWhich(pair)}</b>${meant}`;
  if (label !== null) return html`Recognised as <b class="chosen">${label}</b>${meant}`;
  return html`${
    fault ? `Too poor to judge: ${fault}; nearest is ` : "Not recognised; nearest is "
  }<b>${nearest}</b>${expected === NONE ? meant : ""}`;
}

/**
 * Whether the answer is the expected one; a refusal is where none of the gestures was meant.
 *
 * @param {Recognition} result
 */
const isRight = ({ label, pair, expected, expected_none: none }) =>
  none ? label === null && !pair : label !== null && label === expected;

/**
 * Show what was recognised.
 *
 * @param {State} state
 */
export function drawOutcome({ result }) {
  const box = byId("outcome");
  if (!result) return render(nothing, box);
  const { label, pair } = result;
  const wrong = expectedOf(result) === null ? label === null : !isRight(result);
  const mark = pair ? "?" : wrong ? "\u2260" : "\u2713";
  box.className = `outcome ${pair ? "asked" : wrong ? "wrong" : "right"}`;
  return render(
    html`<span class="outcome-mark" aria-hidden="true">${mark}</span
      ><span>${outcomeWords(result)}<small>${supportWords(result)}</small></span>`,
    box,
  );
}

/**
 * The notes on a clip; that of pictures that are turned has a button that turns them.
 *
 * @param {Clip} clip
 */
function notesOn(clip) {
  const notes = listWarnings(clip, state.gestures);
  const advised = state.timeline?.turn;
  const degrees = /** @type {0 | 90 | 180 | 270} */ (advised || (360 - clip.turn) % 360);
  if (clip.status !== "done" || !degrees) return notes.map((note) => html`<li>${note}</li>`);
  if (!advised) notes.push(`The picture was turned by ${clip.turn}\u00b0.`);
  const at = advised ? notes.findIndex((note) => note.includes("--turn")) : notes.length - 1;
  const turn = async () => {
    await attempt("Turning the picture", () => api.clips.turn(clip.id, degrees));
    await reloadClip(clip.id);
  };
  const label = advised ? `Turn the picture by ${degrees}\u00b0` : "Turn it back";
  const button = html` <button type="button" class="link" data-writes @click=${turn}>
    ${label}
  </button>`;
  return notes.map((note, place) => html`<li>${note}${place === at ? button : nothing}</li>`);
}

/** Draw the bar above the frame. */
export function drawStage() {
  const clip = selectedClip();
  byId("clip-bar").hidden = !clip;
  document.title = clip ? `${clip.name} \u2013 OSG Studio` : "OSG Studio";
  if (!clip) return;
  const done = clip.status === "done";
  const ready = isReadable();
  byId("clip-name").textContent = clip.name;
  byId("clip-meta").textContent = done
    ? ""
    : clip.status === "failed"
      ? (clip.error ?? "")
      : ready
        ? "Still being read: more takes may follow. Save a gesture when it is done."
        : "Its takes appear as soon as they have ended.";
  for (const id of ["recognise", "expected"]) byId(id).disabled = !ready || !state.takes;
  byId("save-gesture").disabled = !done || !state.takes;
  render(notesOn(clip), byId("clip-warnings"));
  render(nothing, byId("range-text"));
  drawTimeline();
}

/** Wire the buttons. */
export function stageButtons() {
  byId("save-gesture").onclick = () =>
    saveGesture().catch((error) => complain(error, "Saving the gesture"));
  byId("recognise").onclick = recognise;
  bindTransport();
  enlargePicture();
  buildRanges(hasLanguage);
}
