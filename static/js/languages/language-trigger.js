// The trigger of the language on display: what begins and ends a take, and the dialog that sets it.

import { takesLanguage } from "../clips/salutes.js";
import * as api from "../core/api.js";
import { closeDialog, showDialog } from "../core/dialogs.js";
import { byId, h } from "../core/dom.js";
import { moment } from "../core/format.js";
import { currentLanguage, selectedClip, selectedRange, update } from "../core/state.js";
import { asOptions, buttonOf, html, live, nothing, optionsOf, render } from "../templates.js";
import { editAndShow } from "./revision-edit.js";

/** @import { State, TriggerDraft } from "../core/types.d.ts" */

/** @typedef {{ name: string, text: string, more: string, draft: TriggerDraft | null, labels?: string[] }} Choice */

const SPOTTED = new Set(["gesture", "none"]); // Kinds of triggers that are not held.
const NO_POSES = { start: null, stop: null, start_label: "", stop_label: "" };

/**
 * The value that the takes of clips depend on; when it changes, takes are loaded again.
 *
 * @param {Pick<State, "gestures">} state
 */
export function triggerKey({ gestures }) {
  if (!gestures?.trigger) return "";
  // Without a trigger, every change of the gestures may change what is spotted.
  const spotted = SPOTTED.has(gestures.trigger.kind) ? gestures.revision : 0;
  return JSON.stringify([takesLanguage(gestures), gestures.trigger, spotted]);
}

/** The range on display as a pose for the API; null where there is none. */
function heldPose() {
  const clip = selectedClip();
  const range = selectedRange();
  if (clip?.status !== "done" || !range) return null;
  return { clip_id: clip.id, start: range.start, end: range.end };
}

/**
 * The choice of a gesture as trigger, with the current start and stop gestures selected.
 *
 * @returns {Choice}
 */
function gestureChoice() {
  const { gestures, trigger } = currentLanguage();
  const labels = gestures.map(({ label }) => label);
  const { start_label: begins = "", stop_label: ends = "" } = trigger ?? {};
  const chosen = {
    start_label: begins || labels[0],
    stop_label: ends === begins ? "" : ends,
  };
  return {
    name: "gesture",
    text: "A gesture of the language",
    more: labels.length
      ? "Only what is shown between two of these gestures is read."
      : "It has no gesture yet.",
    draft: labels.length ? { ...NO_POSES, ...chosen, kind: "gesture" } : null,
    labels,
  };
}

/**
 * The possible triggers; one without a draft first needs a range of a clip.
 *
 * @returns {Choice[]}
 */
function choices() {
  const pose = heldPose();
  const clip = selectedClip();
  const where = pose
    ? `From the range on display: ${clip?.name}, ${moment(pose.start)} \u2013 ${moment(pose.end)}.`
    : "Choose a clip first, and the range in which the pose is held.";
  /** @type {Choice[]} */
  const found = [
    {
      name: "salute",
      text: "A Vulcan salute",
      more: "Its fingers must be seen.",
      draft: { ...NO_POSES, kind: "salute" },
    },
    {
      name: "pose",
      text: "A held pose of the arms",
      more: `No hand needs to be seen. ${where}`,
      draft: pose && { ...NO_POSES, kind: "pose", start: pose },
    },
  ];
  if (currentLanguage().trigger?.kind === "pose")
    found.push({
      name: "stop",
      text: "Another pose of the arms at the end",
      more: `The pose of now begins a take, and this one ends it. ${where}`,
      draft: pose && { ...NO_POSES, kind: "pose", stop: pose },
    });
  found.push(gestureChoice());
  found.push({
    name: "none",
    text: "Nothing",
    more: "Gestures are found anywhere, with more false alarms.",
    draft: { ...NO_POSES, kind: "none" },
  });
  return found;
}

/** @param {TriggerDraft} draft */
async function save(draft) {
  const saved = await editAndShow(
    "Saving the trigger",
    "Change of the trigger",
    (language) => api.languages.setTrigger(language, draft),
    ({ trigger_words: words }) => ["Trigger saved", `Takes ${words}`],
  );
  if (!saved) return;
  closeDialog();
  update({ take: null, start: null, end: null, recognition: null });
}

/**
 * The fields for the gestures that begin and end a take; by default both are the same.
 *
 * @param {Choice} choice
 * @param {() => void} changed
 */
function labelChoice({ labels = [], draft }, changed) {
  /**
   * @param {"start_label" | "stop_label"} end
   * @param {string} title
   * @param {[string, string][]} same
   */
  const choose = (end, title, same) =>
    html`<select
      aria-label=${title}
      @change=${(/** @type {any} */ { target }) => {
        if (draft) draft[end] = target.value;
        changed();
      }}
    >
      ${optionsOf([...same, ...asOptions(labels)], draft?.[end] ?? "")}
    </select>`;
  return html`<span class="trigger-gestures"
    >begins ${choose("start_label", "Gesture that begins a take", [])} ends
    ${choose("stop_label", "Gesture that ends a take", [["", "the same"]])}</span
  >`;
}

/**
 * @param {Choice} choice
 * @param {boolean} checked
 * @param {() => void} choose
 */
const row = (choice, checked, choose) =>
  html`<label>
    <input
      type="radio"
      name="trigger"
      value=${choice.name}
      ?disabled=${!choice.draft}
      .checked=${live(checked)}
      @change=${choose}
    />
    <span
      ><b>${choice.text}</b><small class="dim">${choice.more}</small>${
        choice.labels?.length ? labelChoice(choice, choose) : nothing
      }</span
    >
  </label>`;

/** Open the dialog that sets the trigger of the language on display. */
export function openTrigger() {
  const language = currentLanguage();
  const offered = choices();
  // A pose can be chosen again: it is then taken from the range on display.
  const present = offered.find(
    ({ name }) => name === (language.trigger?.kind ?? "salute") && name !== "pose",
  );
  const form = h("form", { method: "dialog", className: "settings-dialog", noValidate: true });
  /** @param {Choice | null} chosen */
  const draw = (chosen) => {
    form.onsubmit = (event) => {
      event.preventDefault();
      if (chosen?.draft) save(chosen.draft);
    };
    const rows = offered.map((choice) =>
      row(choice, choice === (chosen ?? present), () => draw(choice)),
    );
    render(
      html`<h2 id="dialog-title">What begins and ends a gesture</h2>
        <p class="dim">Now takes lie ${language.trigger_words}. The robot does the same.</p>
        <fieldset class="settings-profiles">
          <legend>Trigger</legend>
          ${rows}
        </fieldset>
        <div class="dialog-actions">
          <span class="spacer"></span>
          <button type="button" @click=${closeDialog}>Cancel</button>
          <button type="submit" class="primary" data-writes ?disabled=${!chosen}>Save</button>
        </div>`,
      form,
    );
  };
  draw(null);
  showDialog(form);
}

/**
 * Show the trigger above the gestures, with a button that changes it.
 *
 * @param {State} state
 */
export function drawTrigger({ gestures }) {
  const box = byId("trigger");
  box.hidden = !gestures;
  const words = html`<span class="dim">Takes lie ${gestures?.trigger_words}. </span>${buttonOf(
      "Change",
      openTrigger,
      { look: "link", writes: true, label: "Change what begins and ends a take" },
    )}`;
  render(gestures ? words : nothing, box);
}
