// The demonstrations of a gesture side by side: each can be removed, and a clip's take added.

import { olderClipsButton } from "../clips/older-clips.js";
import { takesLanguage } from "../clips/salutes.js";
import * as api from "../core/api.js";
import { closeDialog, showDialog } from "../core/dialogs.js";
import { byId, h } from "../core/dom.js";
import { moment } from "../core/format.js";
import { currentLanguage, follow, placeIn, selectedRange, state } from "../core/state.js";
import { MAX_DEMONSTRATIONS, MAX_DIVER_LENGTH } from "../core/text-limit.js";
import { attempt } from "../core/toasts.js";
import { address, go, here } from "../core/views.js";
import { openTrigger } from "../languages/language-trigger.js";
import { editAndShow } from "../languages/revision-edit.js";
import { buttonOf, html, limited, nothing, optionsOf, render } from "../templates.js";
import { isHeld, listFollowed, nameShapes } from "./held-shape.js";

/** @import { Clip, Demonstration, DemonstrationFault, Gesture, Source, Take } from "../core/types.d.ts" */

/** @typedef {{ text: string, start: number | null, end: number | null }} Range */

/**
 * The dialog on display; `range` is the number of the chosen one of the `ranges` of a clip.
 *
 * @typedef {{ label: string, box: HTMLElement, clip: string, ranges: Range[], range: number, adding: boolean, older: HTMLElement }} Shown
 */

/** @type {Shown | null} */
let shown = null;
let followed = false;

/**
 * The address of a trajectory image with start dot and arrow.
 *
 * @param {string} thumbnail
 */
export const withMarks = (thumbnail) =>
  `${api.beside(thumbnail)}${thumbnail.includes("?") ? "&" : "?"}marks=true`;

/**
 * Give a demonstration the range of its clip that mends its fault.
 *
 * @param {string} label
 * @param {Source} source
 * @param {DemonstrationFault} fault
 */
const setRange = (label, { clip_id }, { start, end }) =>
  editAndShow(
    "Setting the range",
    `Range of ${label}`,
    (language) =>
      api.languages.changeGesture(language, label, { demonstration: { clip_id, start, end } }),
    () => ["Range set", label],
  );

/**
 * The faults of a demonstration as a note, with the one remedy of the gravest.
 *
 * @param {string} label
 * @param {number} index which demonstration
 * @param {Source | null | undefined} source
 */
function faultNote(label, index, source) {
  const [fault] = source?.faults ?? [];
  if (!source || !fault) return nothing;
  const ranged = fault.remedy === "set_range" && fault.start !== null && index === 0;
  /** @type {[string, () => void] | null} */
  const mend = ranged
    ? [
        `Set ${moment(fault.start ?? 0)} to ${moment(fault.end ?? 0)}`,
        () => setRange(label, source, fault),
      ]
    : fault.remedy === "arm_trigger"
      ? ["Choose the arm trigger", openTrigger]
      : null;
  return html`<p class="demonstration-fault" title="It ${fault.words}.">
    ${fault.sentence}
    ${
      mend
        ? html`<button type="button" class="link" data-writes @click=${mend[1]}>${mend[0]}</button>`
        : nothing
    }
  </p>`;
}

const gestureShown = () => currentLanguage().gestures.find(({ label }) => label === shown?.label);

/** @param {Source | null | undefined} source */
const clipOf = (source) => source && state.clips.find(({ id }) => id === source.clip_id);

/**
 * @param {string} label
 * @param {number} index
 */
const remove = (label, index) =>
  editAndShow(
    "Removing the demonstration",
    `Removal of a demonstration of ${label}`,
    (language) => api.languages.removeDemonstration(language, label, index),
    () => ["Demonstration removed", label],
  );

/**
 * The clip that a demonstration was taken from, as a link to its range.
 *
 * @param {Source | null | undefined} source
 */
function origin(source) {
  const clip = clipOf(source);
  if (!clip || !source) return html`<span class="dim">its clip is not here</span>`;
  const place = placeIn(clip.id, { start: source.start, end: source.end });
  const open = here(() => {
    closeDialog();
    go("studio", place);
  });
  return html`<a href=${address("studio", place)} @click=${open}>${clip.name}</a>`;
}

/**
 * @param {Gesture} gesture
 * @param {Demonstration} demonstration
 */
function figure(gesture, demonstration) {
  const { index, diver, seconds, thumbnail, source } = demonstration;
  const name = `Demonstration ${index + 1}`;
  const alone = gesture.demonstrations.length === 1;
  const alt = isHeld(demonstration)
    ? `${name} of ${gesture.label}, ${nameShapes(demonstration)}`
    : `${name} of ${gesture.label}, from the dot along the arrow`;
  return html`<li class="demonstration-card">
    <img alt=${alt} width="160" height="160" src=${withMarks(thumbnail)} />
    <b>${diver || name}</b>
    <span class="num">${seconds === null ? "only its image is known" : moment(seconds)}</span>
    <span class="dim">${listFollowed(demonstration)}</span>
    <span class="dim">${demonstration.strokes}</span>
    ${origin(source)}${faultNote(gesture.label, index, source)}
    ${buttonOf("Remove", () => remove(gesture.label, index), {
      writes: true,
      title: alone ? "The only demonstration stays; delete the gesture instead" : "",
      label: `Remove ${name.toLowerCase()}`,
      disabled: alone,
    })}
  </li>`;
}

/**
 * The ranges of a clip that can be added: its takes, and what is selected on the timeline.
 *
 * @param {string} clip
 * @param {Take[]} takes
 */
function rangesOf(clip, takes) {
  const selected = clip === state.clip ? selectedRange() : null;
  /** @type {Range[]} */
  const own = takes.map(({ start, end, stroke_start: from, stroke_end: to }, number) => ({
    text: `Take ${number + 1}, ${moment(from)} to ${moment(to)}`,
    start,
    end,
  }));
  if (selected && !selected.take && state.start !== null)
    own.unshift({
      text: `Selected, ${moment(selected.start)} to ${moment(selected.end)}`,
      start: selected.start,
      end: selected.end,
    });
  return own.length ? own : [{ text: "The whole clip", start: null, end: null }];
}

/**
 * Choose the clip of which a take can be added, and load its ranges.
 *
 * @param {Shown} dialog
 * @param {string} clip
 */
async function chooseClip(dialog, clip) {
  // Until its own are loaded, no range of another clip can be added.
  Object.assign(dialog, { clip, ranges: [] });
  const found = clip
    ? await attempt("Loading the takes", () => api.clips.takes(clip, takesLanguage(state.gestures)))
    : [];
  if (!found || clip !== dialog.clip) return;
  dialog.ranges = rangesOf(clip, found);
  const selected = clip === state.clip ? (state.take ?? 0) : 0;
  dialog.range = dialog.ranges[selected] ? selected : 0;
  draw();
}

/** @param {SubmitEvent} event */
async function add(event) {
  event.preventDefault();
  if (!shown) return;
  const dialog = shown;
  const { label, clip, ranges, range } = dialog;
  const { start, end } = ranges[range] ?? { start: null, end: null };
  const diver = byId("demonstration-diver");
  const body = { label, clip_id: clip, start, end, diver: diver.value.trim() };
  dialog.adding = true;
  draw();
  const added = await editAndShow(
    "Adding the demonstration",
    `Another demonstration of ${label}`,
    (language) => api.languages.addDemonstration(language, body),
    () => ["Demonstration added", label],
  );
  if (added) diver.value = "";
  dialog.adding = false;
  draw();
}

/**
 * The form that adds a take of a clip.
 *
 * @param {Shown} dialog
 * @param {Clip[]} clips
 */
function addForm(dialog, clips) {
  const { clip, ranges, range, adding, older } = dialog;
  const pickClip = (/** @type {any} */ { target }) => {
    chooseClip(dialog, target.value);
    draw();
  };
  const pickRange = (/** @type {any} */ { target }) => {
    dialog.range = Number(target.value);
  };
  return html`<form class="demonstration-add" aria-label="Another demonstration" @submit=${add}>
    <h3>Another demonstration, best by another diver</h3>
    <div class="field">
      <label for="demonstration-clip">Clip</label>
      <select id="demonstration-clip" @change=${pickClip}>
        ${optionsOf(
          clips.map(({ id, name }) => [id, name]),
          clip,
        )}
      </select>
    </div>
    ${older}
    <div class="field">
      <label for="demonstration-take">Range</label>
      <select id="demonstration-take" @change=${pickRange}>
        ${optionsOf(
          ranges.map(({ text }, index) => [String(index), text]),
          String(range),
        )}
      </select>
    </div>
    <div class="field">
      <label for="demonstration-diver">Diver</label>
      <input type="text" id="demonstration-diver" autocomplete="off" ${limited(MAX_DIVER_LENGTH)} />
    </div>
    <button type="submit" class="primary" data-writes ?disabled=${adding || !ranges.length}>
      Add
    </button>
  </form>`;
}

function draw() {
  if (!shown?.box.isConnected) return;
  const gesture = state.gestures && gestureShown();
  if (!gesture) {
    closeDialog();
    return;
  }
  const { demonstrations, label } = gesture;
  const clips = state.clips.filter(({ status }) => status === "done");
  // The chosen clip stays; at first it is the one on display.
  const wanted = [shown.clip, state.clip].find((id) => clips.some((clip) => clip.id === id));
  const clip = wanted ?? clips[0]?.id ?? "";
  if (clip !== shown.clip) chooseClip(shown, clip);
  render(
    html`<h2 id="dialog-title">Demonstrations of ${label}</h2>
      <p class="dim">
        A take is compared with each of them, and the nearest counts. A gesture has
        ${MAX_DEMONSTRATIONS} at most.
      </p>
      <ul class="demonstration-cards" aria-label="Demonstrations">
        ${demonstrations.map((each) => figure(gesture, each))}
      </ul>
      ${demonstrations.length < MAX_DEMONSTRATIONS ? addForm(shown, clips) : nothing}
      <div class="dialog-actions">
        <button type="button" @click=${closeDialog}>Close</button>
      </div>`,
    shown.box,
  );
}

/**
 * Compare the demonstrations of a gesture in a dialog.
 *
 * @param {string} label
 */
export function openDemonstrations(label) {
  const box = h("div", { className: "demonstrations-dialog" });
  const older = olderClipsButton();
  shown = { label, box, clip: "", ranges: [], range: 0, adding: false, older };
  byId("dialog").replaceChildren(box);
  if (!followed) {
    followed = true;
    follow(["gestures", "clips"], draw);
  } else draw();
  showDialog(box);
}
