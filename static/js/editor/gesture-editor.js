// The editor of a gesture. Only "Save" changes the language; until then there is a draft.

import * as api from "../core/api.js";
import { byId, h, WRITES } from "../core/dom.js";
import { ago } from "../core/format.js";
import { bind } from "../core/key-bindings.js";
import { currentLanguage, follow, selectedRange, state } from "../core/state.js";
import { attempt, complain, toast } from "../core/toasts.js";
import { showDone } from "../core/undo.js";
import { go, guard } from "../core/views.js";
import { demonstrationOf } from "../clips/demonstration-ranges.js";
import { focusCard } from "../gestures/gesture-cards.js";
import { labelIfNew, labelOf } from "../gestures/gesture-rows.js";
import { choose, reloadLanguages } from "../languages/language-store.js";
import { written } from "../languages/robot-command.js";
import { NONE } from "../languages/test-set.js";
import { take } from "./demonstration-panel.js";
import { furtherOf, knownLabel, requestOf, save } from "./draft-saving.js";
import {
  begin,
  canRedo,
  canUndo,
  change,
  discard,
  draft,
  forget,
  isChanged,
  isKept,
  placeOf,
  redo,
  saved,
  takeAlong,
  undo,
} from "./gesture-draft.js";
import { switches, textProblem, texts } from "./gesture-form.js";
import { mayLeave } from "./leave-dialog.js";
import { previewing } from "./preview-requests.js";
import { health, image } from "./preview-results.js";
import { keypoints, toggle } from "./salient-keypoints.js";

/** @import { Gesture, Language, Outlook, Preview, SelectedRange } from "../core/types.d.ts" */

/** @import { Draft, Where } from "./gesture-draft.js" */

/**
 * The gesture that is edited; `gesture` is null for a new one.
 *
 * @typedef {{ language: Language, gesture: string | null, key: string }} Subject */

const GROUP = "Editing a gesture";

/** @type {{ about: Subject, take: ReturnType<typeof take>, changed: () => void } | null} */
let editor = null; // the one on display

/** The gesture to edit: one of the language, or a new one from the selected range. */
function subject() {
  const { gestures, gesture, clip, clips, loaded } = state;
  if (!gestures || gestures.id !== state.language || !loaded) return null;
  if (gesture) return { language: gestures, gesture, key: `${gestures.id} ${gesture}` };
  if (
    !clip ||
    !clips.some((each) => each.id === clip && each.status === "done") ||
    !state.takes ||
    !state.timeline
  )
    return null;
  return { language: gestures, gesture: null, key: `${gestures.id} new ${clip}` };
}

/**
 * Whether the clip of a demonstration can be shown.
 *
 * @param {Pick<Where, "clip_id"> | null | undefined} where
 */
const isThere = (where) =>
  where && state.clips.some(({ id, status }) => id === where.clip_id && status === "done");

/**
 * The gesture that is edited, for code that runs only where there is one.
 *
 * @param {Pick<Subject, "language" | "gesture">} about
 */
function gestureOf({ language, gesture }) {
  const found = language.gestures.find(({ label }) => label === gesture);
  if (!found) throw new Error(`No gesture is called ${gesture}.`);
  return found;
}

/**
 * @param {Subject} about
 * @returns {Draft}
 */
function valuesOf({ language, gesture }) {
  if (gesture === null) {
    const { start, end } = /** @type {SelectedRange} */ (selectedRange());
    const name = state.clips.find(({ id }) => id === state.clip)?.name ?? "";
    const clip = { clip_id: state.clip ?? "", start, end, keep_transit: false };
    const expected = byId("expected").value;
    return {
      label: labelIfNew((expected !== NONE && expected) || labelOf(name), language, clip),
      description: "",
      command: "",
      salient: null,
      direction: "auto",
      tempo: "auto",
      mirror: "auto",
      hand_shape: "auto",
      clip,
    };
  }
  const shown = gestureOf({ language, gesture });
  const { label, description, command, salient, direction, tempo, mirror, source } = shown;
  return {
    label,
    description,
    command: written(command),
    salient: salient.length ? [...salient].sort() : null,
    direction,
    tempo,
    mirror,
    hand_shape: shown.hand_shape,
    clip: source && isThere(source) ? demonstrationOf(source) : null,
  };
}

/**
 * @param {HTMLElement} section
 * @param {Subject} about
 */
function build(section, about) {
  const { language, gesture } = about;
  const others = () =>
    currentLanguage()
      .gestures.map((each) => each.label)
      .filter((label) => label !== (gesture ?? draft().label.trim()));
  /** The gesture of which a new range would be a further demonstration, or null. */
  const further = () => (gesture === null ? knownLabel(currentLanguage(), draft()) : null);
  const drawn = gesture !== null && !gestureOf(about).has_trajectory;
  /** @type {Preview | null} */
  let preview = null;
  /** @type {Outlook | null} */
  let estimate = null;
  /** @type {Outlook | null} */
  let before = null; // the estimate of what is saved
  /** @param {string} landmark */
  const pick = (landmark) => {
    if (!toggle(landmark, preview))
      toast("One keypoint stays", "At least one keypoint is followed; choose another one first.");
  };
  const parts = {
    take: take({ language: language.id, gesture, drawn, pick }),
    image: image(),
    keypoints: keypoints(() => preview),
    health: health(language.name),
    texts: texts(others),
    switches: switches(),
  };
  /**
   * @param {string} text
   * @param {string} title
   * @param {() => unknown} run
   * @param {string} [className]
   */
  const button = (text, title, run, className = "") =>
    h("button", { type: "button", className, title, onclick: run }, text);
  const undoing = button("Undo", "Undo (Ctrl+Z)", undo);
  const redoing = button("Redo", "Redo (Ctrl+Shift+Z)", redo);
  const saving = h(
    "button",
    { type: "submit", className: "primary", ...WRITES },
    gesture === null ? "Save gesture" : "Save",
  );
  const status = h("span", { className: "draft-state dim", role: "status" });
  const restored = h("p", { className: "restored", role: "status", hidden: true });
  const problem = h("p", { className: "field-problem", role: "alert", hidden: true });

  const ask = previewing({
    shown: (found, estimated) => {
      preview = found;
      estimate = estimated;
      if (estimated && !isChanged() && gesture !== null) before = estimated;
      draw();
    },
    failed: (error) => complain(error, "The preview"),
  });

  function draw() {
    parts.texts.draw();
    parts.switches.draw(estimate);
    parts.keypoints.draw(preview);
    parts.take.draw(preview);
    parts.image.draw(preview);
    parts.health.draw(estimate, before, preview?.problem);
    undoing.disabled = !canUndo();
    redoing.disabled = !canRedo();
    status.textContent = isChanged() ? "Draft, not saved yet" : gesture === null ? "" : "As saved";
    restored.hidden = restored.hidden || !isChanged();
    saving.disabled =
      (gesture !== null && !isChanged()) || textProblem(draft(), others())?.id === "editor-label";
    if (gesture === null) saving.textContent = further() ? `Add to ${further()}` : "Save gesture";
  }

  function changed() {
    problem.hidden = true;
    draw();
    const more = further();
    const request = requestOf(gesture, draft(), saved(), drawn && !draft().clip);
    ask(language.id, more ? { label: more, change: furtherOf(draft()) } : request);
  }

  function abandon() {
    forget();
    close();
    return go(null, { gesture: null });
  }

  /** @param {SubmitEvent} event */
  async function submit(event) {
    event.preventDefault();
    const fault = textProblem(draft(), others());
    if (fault) return showProblem(fault.text, document.getElementById(fault.id));
    saving.disabled = true;
    isSaving = true;
    try {
      const label = draft().label.trim();
      const more = further();
      const now = await save(about.language, gesture, draft(), saved());
      await abandon();
      const shown = preview?.strokes ? `: ${preview.strokes}` : `, in ${now.name}`;
      showDone(more ? "Demonstration added" : "Gesture saved", label + shown);
      focusCard(more || label);
    } catch (error) {
      if (error.code !== "cancelled") showProblem(error.message);
      else abandon(); // The user kept somebody else's edit.
    } finally {
      isSaving = false;
      saving.disabled = false;
    }
    return undefined;
  }

  /**
   * @param {string} text
   * @param {HTMLElement | null} [input]
   */
  function showProblem(text, input) {
    problem.textContent = text;
    problem.hidden = false;
    input?.focus();
  }

  const form = h(
    "form",
    { className: "editor-page", noValidate: true, onsubmit: submit },
    h(
      "div",
      { className: "page-head" },
      h("h1", {}, gesture === null ? "New gesture" : `Edit ${gesture}`),
      h("span", { className: "dim in-language" }, `in ${language.name}`),
      status,
      h("span", { className: "spacer" }),
      h(
        "div",
        { className: "editor-actions" },
        undoing,
        redoing,
        button("Cancel", "Back without saving", leave),
        saving,
      ),
    ),
    restored,
    problem,
    h(
      "div",
      { className: "editor-grid" },
      h("div", { className: "column" }, parts.take.element, parts.keypoints.element),
      h("div", { className: "column" }, parts.image.element, parts.health.element),
      h("div", { className: "column" }, parts.texts.element, parts.switches.element),
    ),
  );
  const kept = begin(
    placeOf(language.id, gesture ?? `new ${state.clip}`),
    valuesOf(about),
    changed,
  );
  // The clip of a kept draft may have been deleted.
  if (draft().clip && !isThere(draft().clip)) change({ clip: saved().clip });
  if (kept !== null) {
    restored.replaceChildren(
      `A draft that was not saved, last changed ${ago(kept)}, is restored.`,
      button("Discard the draft", "Go back to what is saved; Undo brings the draft back", discard),
    );
    restored.hidden = false;
  }
  section.replaceChildren(form);
  editor = { about, take: parts.take, changed };
  changed();
  if (gesture === null) parts.texts.focus();
}

let isSaving = false;

function close() {
  editor?.take.pause();
  editor = null;
}

/** After the browser's Back: show that the draft is kept. */
function left() {
  if (!editor) return;
  const { gesture, language } = editor.about;
  const kept = isKept();
  close();
  if (!kept) return;
  const away = state.view !== "gesture" || state.language !== language.id;
  const goOn = async () => {
    if (state.language !== language.id) await choose(language.id);
    await go("gesture", { gesture });
  };
  toast("The draft is kept", `${gesture ?? "The new gesture"} is not saved yet.`, {
    action: away ? { label: "Go on editing", run: goOn } : null,
  });
}

/**
 * Leave the editor after its language was deleted elsewhere.
 *
 * @param {Subject} about
 */
function bereft(about) {
  const {
    gesture,
    language: { id, name },
  } = about;
  const kept = isKept();
  close();
  go(null, { gesture: null });
  const restore = async () => {
    await attempt("Bringing the language back", () => api.languages.restore(id));
    await reloadLanguages();
    await choose(id);
    await go("gesture", { gesture });
  };
  toast(
    `\u201c${name}\u201d was deleted elsewhere`,
    kept ? "The draft is kept, and comes back with the language." : "",
    { kind: "error", action: { label: "Bring it back", run: restore } },
  );
}

/** Whether the gesture of a changed draft is not in its language (any more). */
const isOrphaned = () =>
  editor !== null &&
  isChanged() &&
  state.gestures?.id === editor.about.language.id &&
  !isKnown({ ...editor.about, language: state.gestures });

let isFollowing = false;

/**
 * Go on with the draft under the label that the gesture was given elsewhere; keep the draft where
 * the gesture was deleted.
 */
async function followRename() {
  if (!editor || !state.gestures || isFollowing) return;
  const { gesture, language } = editor.about;
  const newest = state.gestures.revision;
  isFollowing = true;
  const compared = await attempt("Finding the gesture", () =>
    api.languages.compare(language.id, language.revision, newest),
  );
  isFollowing = false;
  if (!isOrphaned()) return;
  const label = compared?.gestures.find(({ before }) => before?.label === gesture)?.after?.label;
  takeAlong(placeOf(language.id, label ?? String(gesture)));
  close();
  const title = `\u201c${gesture}\u201d was ${label ? "renamed" : "deleted"} elsewhere`;
  if (label) toast(title, `Your draft goes on as a change of \u201c${label}\u201d.`);
  else toast(title, "The draft is kept, and comes back with the gesture.", { kind: "error" });
  await go(label ? "gesture" : null, { gesture: label ?? null });
}

const leave = () => go(null, { gesture: null });

/** @param {HTMLElement} section */
function explain(section) {
  const { gestures, gesture } = state;
  const missing = gestures && gesture && !gestures.gestures.some((each) => each.label === gesture);
  section.replaceChildren(
    h(
      "div",
      { className: "editor-empty" },
      h("h1", {}, missing ? `There is no gesture \u201c${gesture}\u201d` : "No gesture is chosen"),
      h(
        "p",
        { className: "dim" },
        missing
          ? `\u201c${gestures.name}\u201d has none of that label (any more); it may have been renamed or deleted.`
          : "Choose a gesture of the language, or a take of a clip to make one of.",
      ),
      h("button", { type: "button", className: "primary", onclick: leave }, "Back to the studio"),
    ),
  );
}

/**
 * Whether the language has the gesture that is edited.
 *
 * @param {Subject} about
 */
const isKnown = ({ language, gesture }) =>
  gesture === null || language.gestures.some((each) => each.label === gesture);

/** Whether everything is loaded and there is nothing to edit. */
const nothingComes = () =>
  state.loaded && (state.gestures || !state.languages.length) && (state.gesture || !state.clip);

/**
 * Build the view, and build it anew when something else is edited.
 *
 * @param {HTMLElement} section
 */
export function open(section) {
  follow(
    [
      "view",
      "gesture",
      "gestures",
      "languages",
      "language",
      "clip",
      "clips",
      "takes",
      "timeline",
      "loaded",
    ],
    () => {
      if (state.view !== "gesture") return left();
      const edited = editor?.about;
      if (edited && !state.languages.some(({ id }) => id === edited.language.id))
        return bereft(edited);
      // A gesture that is renamed has its new label before the draft is forgotten.
      if (isSaving) return undefined;
      const about = subject();
      if (isOrphaned()) return followRename();
      if (!about || !isKnown(about)) {
        left();
        if (nothingComes()) explain(section);
        return undefined;
      }
      if (edited?.key === about.key) return adopt(edited, about);
      left();
      return build(section, about);
    },
  );
  // The server is back: repeat the requests that failed meanwhile.
  follow(["returns"], () => editor?.changed());
  guard("gesture", () => (editor && isChanged() ? mayLeave() : true));
}

const when = () => state.view === "gesture" && editor !== null;
/**
 * @param {string[]} names
 * @param {string} text
 * @param {() => void} run
 */
const keys = (names, text, run) => bind({ keys: names, text, group: GROUP, run, when });
keys(["Ctrl+Z"], "Undo in the draft", undo);
keys(["Ctrl+Shift+Z", "Ctrl+Y"], "Redo in the draft", redo);
keys(["Space"], "Play or pause the demonstration", () => editor?.take.play());
for (const [key, by, text] of /** @type {[string, number, string][]} */ ([
  [",", -1, "One frame back"],
  [".", 1, "One frame on"],
  ["Shift+,", -10, "Ten frames back"],
  ["Shift+.", 10, "Ten frames on"],
]))
  keys([key], text, () => editor?.take.step(by));
keys(["["], "Let the demonstration start here", () => editor?.take.setHere("start"));
keys(["]"], "Let the demonstration end here", () => editor?.take.setHere("end"));

/**
 * Continue on a newer revision of the language, if it left this gesture unchanged.
 *
 * @param {Subject} edited
 * @param {Subject} about
 */
function adopt(edited, about) {
  /** @param {Gesture} gesture */
  const named = ({ label }) => label === about.gesture;
  const [now, then] = [about, edited].map(({ language }) => language.gestures.find(named));
  /** @param {Gesture | undefined} gesture */
  const content = (gesture) =>
    gesture && JSON.stringify({ ...gesture, thumbnail: null, source: null });
  if (content(now) === content(then)) edited.language = about.language;
}
