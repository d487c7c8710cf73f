// The demonstrations of a gesture side by side: each can be removed, and a clip's take added.

import { olderClipsButton } from "../clips/older-clips.js";
import { takesLanguage } from "../clips/salutes.js";
import * as api from "../core/api.js";
import { byId, h, WRITES } from "../core/dom.js";
import { moment } from "../core/format.js";
import { currentLanguage, follow, selectedRange, state } from "../core/state.js";
import { limit, MAX_DEMONSTRATIONS, MAX_DIVER_LENGTH } from "../core/text-limit.js";
import { attempt, complain } from "../core/toasts.js";
import { showDone } from "../core/undo.js";
import { address, go, here } from "../core/views.js";
import { openTrigger } from "../languages/language-trigger.js";
import { edit } from "../languages/revision-edit.js";
import { isHeld, listFollowed, nameShapes } from "./held-shape.js";

/** @import { Clip, Demonstration, DemonstrationFault, Gesture, Source, Take } from "../core/types.d.ts" */

/** @typedef {{ text: string, start: number | null, end: number | null }} Range */

/**
 * The dialog on display.
 *
 * @type {{ label: string, content: HTMLElement, drawn: string, adding: ReturnType<typeof addForm> } | null}
 */
let shown = null;
let followed = false;

/**
 * The address of a trajectory image with start dot and arrow.
 *
 * @param {string} thumbnail
 */
export const withMarks = (thumbnail) =>
  `${api.beside(thumbnail)}${thumbnail.includes("?") ? "&" : "?"}marks=true`;

const SHORT_FAULTS = {
  whole_clip: "whole clip",
  contains_salute: "contains a salute",
  reaches_salute: "reaches the salutes",
  cut_short: "cut short",
  contains_rest: "contains rest",
  other_person: "another person",
  keypoints_jumped: "keypoints jump",
  keypoints_missing: "keypoints missing",
  no_hand: "no hand seen",
};

/**
 * The gravest fault of a demonstration in a few words, for a tag.
 *
 * @param {Pick<Source, "faults">} source
 */
export const shortFault = ({ faults }) => SHORT_FAULTS[faults[0].kind];

/**
 * Give a demonstration the range of its clip that mends its fault.
 *
 * @param {string} label
 * @param {Source} source
 * @param {DemonstrationFault} fault
 */
async function setRange(label, { clip_id }, { start, end }) {
  try {
    await edit("Setting the range", `Range of ${label}`, (language) =>
      api.languages.changeGesture(language, label, { demonstration: { clip_id, start, end } }),
    );
    showDone("Range set", label);
  } catch (error) {
    complain(error, "Setting the range");
  }
}

/**
 * The faults of a demonstration as a note, with the one remedy of the gravest.
 *
 * @param {string} label
 * @param {number} index which demonstration
 * @param {Source | null | undefined} source
 */
export function faultNote(label, index, source) {
  const [fault] = source?.faults ?? [];
  if (!source || !fault) return null;
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
  return h(
    "p",
    { className: "demonstration-fault", title: `It ${fault.words}.` },
    `${fault.sentence} `,
    mend
      ? h("button", { type: "button", className: "link", ...WRITES, onclick: mend[1] }, mend[0])
      : null,
  );
}

const gestureShown = () => currentLanguage().gestures.find(({ label }) => label === shown?.label);

/** @param {Source | null | undefined} source */
const clipOf = (source) => source && state.clips.find(({ id }) => id === source.clip_id);

/**
 * @param {string} label
 * @param {number} index
 */
async function remove(label, index) {
  try {
    await edit("Removing the demonstration", `Removal of a demonstration of ${label}`, (language) =>
      api.languages.removeDemonstration(language, label, index),
    );
    showDone("Demonstration removed", label);
  } catch (error) {
    complain(error, "Removing the demonstration");
  }
}

/**
 * The clip that a demonstration was taken from, as a link to its range.
 *
 * @param {Source | null | undefined} source
 */
function origin(source) {
  const clip = clipOf(source);
  if (!clip || !source) return h("span", { className: "dim" }, "its clip is not here");
  const place = {
    clip: clip.id,
    take: null,
    start: source.start,
    end: source.end,
    recognition: null,
  };
  return h(
    "a",
    {
      href: address("studio", place),
      onclick: here(() => {
        byId("dialog").close();
        go("studio", place);
      }),
    },
    clip.name,
  );
}

/**
 * @param {Gesture} gesture
 * @param {Demonstration} demonstration
 */
function figure(gesture, demonstration) {
  const { index, diver, seconds, thumbnail, source } = demonstration;
  const name = `Demonstration ${index + 1}`;
  const alone = gesture.demonstrations.length === 1;
  return h(
    "li",
    { className: "demonstration-card" },
    h("img", {
      src: withMarks(thumbnail),
      alt: isHeld(demonstration)
        ? `${name} of ${gesture.label}, ${nameShapes(demonstration)}`
        : `${name} of ${gesture.label}, from the dot along the arrow`,
      width: 160,
      height: 160,
    }),
    h("b", {}, diver || name),
    h("span", { className: "num" }, seconds === null ? "only its image is known" : moment(seconds)),
    h("span", { className: "dim" }, listFollowed(demonstration)),
    h("span", { className: "dim" }, demonstration.strokes),
    origin(source),
    faultNote(gesture.label, index, source),
    h(
      "button",
      {
        type: "button",
        ...WRITES,
        disabled: alone,
        title: alone ? "The only demonstration stays; delete the gesture instead" : "",
        "aria-label": `Remove ${name.toLowerCase()}`,
        onclick: () => remove(gesture.label, index),
      },
      "Remove",
    ),
  );
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
 * The form that adds a take of a clip.
 *
 * @param {string} label
 */
function addForm(label) {
  const clips = h("select", { id: "demonstration-clip" });
  const takes = h("select", { id: "demonstration-take" });
  const diver = limit(
    h("input", { type: "text", id: "demonstration-diver", autocomplete: "off" }),
    MAX_DIVER_LENGTH,
  );
  const button = h("button", { type: "submit", className: "primary", ...WRITES }, "Add");
  /** @type {Range[]} */
  let ranges = [];
  const load = async () => {
    const clip = clips.value;
    const found = clip
      ? await attempt("Loading the takes", () =>
          api.clips.takes(clip, takesLanguage(state.gestures)),
        )
      : [];
    if (!found || clip !== clips.value) return;
    ranges = rangesOf(clip, found);
    takes.replaceChildren(...ranges.map(({ text }, index) => h("option", { value: index }, text)));
    if (clip === state.clip && ranges[state.take ?? 0]) takes.value = String(state.take ?? 0);
  };
  clips.onchange = load;
  let offered = "";
  /** Offer the clips that have poses by now; the choice among them stays. */
  const offer = () => {
    const ready = state.clips.filter(({ status }) => status === "done");
    const now = ready.map(({ id, name }) => `${id} ${name}`).join();
    if (now === offered) return;
    offered = now;
    const wanted = clips.value || state.clip;
    clips.replaceChildren(...ready.map(({ id, name }) => h("option", { value: id }, name)));
    if (ready.some(({ id }) => id === wanted)) clips.value = wanted ?? "";
    load();
  };
  /**
   * @param {string} label
   * @param {HTMLElement} input
   */
  const field = (label, input) =>
    h("div", { className: "field" }, h("label", { for: input.id }, label), input);
  const form = h(
    "form",
    { className: "demonstration-add", "aria-label": "Another demonstration" },
    h("h3", {}, "Another demonstration, best by another diver"),
    field("Clip", clips),
    olderClipsButton(),
    field("Range", takes),
    field("Diver", diver),
    button,
  );
  form.onsubmit = async (event) => {
    event.preventDefault();
    const { start, end } = ranges[Number(takes.value)] ?? { start: null, end: null };
    const body = { label, clip_id: clips.value, start, end, diver: diver.value.trim() };
    button.disabled = true;
    try {
      await edit("Adding the demonstration", `Another demonstration of ${label}`, (language) =>
        api.languages.addDemonstration(language, body),
      );
      diver.value = "";
      showDone("Demonstration added", label);
    } catch (error) {
      complain(error, "Adding the demonstration");
    } finally {
      button.disabled = false;
    }
  };
  return { form, offer };
}

function draw() {
  if (!shown?.content.isConnected) return;
  const gesture = state.gestures && gestureShown();
  if (!gesture) return byId("dialog").close();
  const { demonstrations } = gesture;
  // Only changed content is drawn anew, so that a focused link or button stays.
  const now = JSON.stringify(demonstrations.map((each) => [each, clipOf(each.source)?.name]));
  if (now !== shown.drawn) {
    shown.drawn = now;
    shown.content.replaceChildren(...demonstrations.map((each) => figure(gesture, each)));
  }
  shown.adding.form.hidden = demonstrations.length >= MAX_DEMONSTRATIONS;
  shown.adding.offer();
  return undefined;
}

/**
 * Compare the demonstrations of a gesture in a dialog.
 *
 * @param {string} label
 */
export function openDemonstrations(label) {
  const dialog = byId("dialog");
  const content = h("ul", { className: "demonstration-cards", "aria-label": "Demonstrations" });
  const adding = addForm(label);
  shown = { label, content, drawn: "", adding };
  dialog.replaceChildren(
    h(
      "div",
      { className: "demonstrations-dialog" },
      h("h2", { id: "dialog-title" }, `Demonstrations of ${label}`),
      h(
        "p",
        { className: "dim" },
        `A take is compared with each of them, and the nearest counts. A gesture has ${MAX_DEMONSTRATIONS} at most.`,
      ),
      content,
      adding.form,
      h(
        "div",
        { className: "dialog-actions" },
        h("button", { type: "button", onclick: () => dialog.close() }, "Close"),
      ),
    ),
  );
  dialog.setAttribute("aria-labelledby", "dialog-title");
  dialog.onclose = null;
  dialog.showModal();
  if (!followed) {
    followed = true;
    follow(["gestures", "clips"], draw);
  } else draw();
}
