// The gestures of the language, as cards with their trajectory images.

import { expectedOf, NONE } from "../languages/test-set.js";
import { labelInName } from "../clips/clip-label.js";
import { endName } from "../clips/salutes.js";
import * as api from "../core/api.js";
import { byId, h } from "../core/dom.js";
import { plural, readable } from "../core/format.js";
import { currentLanguage, selectedClip, state } from "../core/state.js";
import { go } from "../core/views.js";
import { editAndShow } from "../languages/revision-edit.js";
import { openSettings } from "../languages/settings-dialog.js";
import { buttonOf, html, iconButtonOf, nothing, render, repeat } from "../templates.js";
import { isHeld, listFollowed, nameShapes } from "./held-shape.js";
import { openDemonstrations, withMarks } from "./demonstrations-dialog.js";

/** @import { Gesture, Language, Recognition, State } from "../core/types.d.ts" */

/** @param {Gesture} gesture */
function remove(gesture) {
  const from = currentLanguage();
  const mine = { ...from, gestures: from.gestures.filter((each) => each.label !== gesture.label) };
  editAndShow(
    "Deleting the gesture",
    `Deletion of ${gesture.label}`,
    (language) => api.languages.removeGesture(language, gesture.label),
    () => ["Gesture deleted", gesture.label],
    { from, mine },
  );
}

/**
 * The tag of a gesture with a bad demonstration; the text says what is wrong with it.
 *
 * @param {Gesture} gesture
 */
function faultTag({ demonstrations }) {
  const bad = demonstrations.map(({ source }) => source).find((source) => source?.faults.length);
  if (!bad) return nothing;
  const [{ kind, sentence }] = bad.faults;
  const words = readable(kind).replace("salute", endName(state.gestures));
  return html`<span class="tag fault" title=${sentence}>${words}</span>`;
}

/**
 * What a gesture is in the recognition on display; null: nothing.
 *
 * @param {Gesture} gesture
 */
function markOf({ label }) {
  const { result } = state;
  if (!result) return null;
  if ((result.pair ?? [result.label]).includes(label)) return "chosen";
  return label === result.expected ? "expected" : null;
}

/** @param {Gesture} gesture */
function card(gesture) {
  const { label, description, demonstrations } = gesture;
  const mark = markOf(gesture);
  const tag = mark === "chosen" && state.result?.pair ? "one of two" : mark;
  const [{ strokes }] = demonstrations;
  const count = plural(demonstrations.length, "demonstration");
  const alt = isHeld(gesture)
    ? `Picture of ${label}, ${nameShapes(gesture)}`
    : `Trajectory of ${label}, from the dot along the arrow`;
  return html`<li class="card ${mark ?? ""}" data-key=${label}>
    <img alt=${alt} loading="lazy" width="112" height="112" src=${withMarks(gesture.thumbnail)} />
    <div class="card-text">
      <b title=${label}>${label}</b>
      <span>${description || listFollowed(gesture)}</span>
      ${strokes ? html`<span title="Strokes: ${strokes}">${strokes}</span>` : nothing}
      ${buttonOf(count, () => openDemonstrations(label), {
        look: "link",
        label: `${count} of ${label}`,
      })}
      ${mark ? html`<span class="tag ${mark}">${tag}</span>` : nothing}${faultTag(gesture)}
    </div>
    <div class="card-buttons">
      ${iconButtonOf("rename", `Change ${label}`, () => go("gesture", { gesture: label }))}
      ${iconButtonOf("trash", `Delete ${label}`, () => remove(gesture), { writes: true })}
    </div>
  </li>`;
}

/**
 * Fold away the gestures of a sample while the studio has nothing of the user's own.
 *
 * @param {State} state
 */
function foldSample({ clips, gestures, languages, loaded }) {
  const fold = byId("gestures-fold");
  if (!loaded || !gestures) return;
  const own = !gestures.sample || clips.length > 0 || languages.some(({ sample }) => !sample);
  byId("gesture-whose").textContent = own ? "" : `of the sample \u201c${gestures.name}\u201d`;
  if (fold.dataset.own === String(own)) return; // The user may have unfolded it.
  fold.dataset.own = String(own);
  fold.open = own;
}

/**
 * The revision and the short code, for comparison with the language on a robot.
 *
 * @param {Language | null} language
 */
function drawCarried(language) {
  const box = byId("carried");
  const carried = language?.gestures.length ? language : null;
  box.hidden = !carried;
  const words = html`A robot that has revision ${carried?.revision} shows
    <code>${carried?.code}</code>.
    <button type="button" class="link" @click=${openSettings}>Settings</button>`;
  render(words, box);
}

/** @param {State} state */
export function drawGestures(state) {
  const { gestures, result, languages, loaded } = state;
  foldSample(state);
  const members = gestures?.gestures ?? [];
  byId("gesture-count").textContent = members.length ? String(members.length) : "";
  drawCarried(gestures);
  const empty = byId("gestures-empty");
  empty.hidden = members.length > 0 || (!gestures && (!loaded || languages.length > 0));
  empty.textContent = gestures
    ? "No gestures yet. Select a take of a clip and press \u201cSave as gesture\u201d: one demonstration is enough."
    : "No language yet. Make one with +, or drop a language file (.json).";
  render(
    repeat(members, ({ label }) => label, card),
    byId("gestures"),
  );
  drawExpected(members, result);
}

/** @type {{ result: string | null, clip: string | null | undefined }} */
let shown = { result: null, clip: null };

/**
 * Fill the choice of the expected label; opening a recognition selects its label.
 *
 * @param {Gesture[]} members
 * @param {Recognition | null} result
 */
function drawExpected(members, result) {
  const expected = byId("expected");
  const clip = selectedClip();
  const labels = members.map(({ label }) => label);
  let expectedLabel = expected.value;
  if (result && result.id !== shown.result) expectedLabel = expectedOf(result) ?? "";
  else if (clip?.id !== shown.clip) expectedLabel = labelInName(clip?.name ?? "", labels);
  // The language may be loaded after the clip: until then there was no label to propose.
  shown = { result: result?.id ?? null, clip: members.length ? clip?.id : null };
  expected.replaceChildren(
    h("option", { value: "" }, "not known"),
    ...[...labels, NONE].map((value) => h("option", { value }, value)),
  );
  expected.value = [...labels, NONE].includes(expectedLabel) ? expectedLabel : "";
}

/**
 * Give the focus, which was on the button that is gone, to the card of a gesture.
 *
 * @param {string} label
 */
export function focusCard(label) {
  const button = byId("gestures").querySelector(`[data-key="${CSS.escape(label)}"] button`);
  (button ?? byId("stage")).focus({ preventScroll: true });
}
