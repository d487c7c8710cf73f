// The editor of a gesture. Only "Save" changes the language; until then there is a draft.

import * as api from "../core/api.js";
import { byId } from "../core/dom.js";
import { ago } from "../core/format.js";
import { bind } from "../core/key-bindings.js";
import { currentLanguage, follow, state } from "../core/state.js";
import { attempt, complain, toast } from "../core/toasts.js";
import { showDone } from "../core/undo.js";
import { go, guard } from "../core/views.js";
import { focusCard } from "../gestures/gesture-cards.js";
import { choose, reloadLanguages } from "../languages/language-store.js";
import { buttonOf, html, render } from "../templates.js";
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
  gestureOf,
  isChanged,
  isKept,
  isThere,
  placeOf,
  redo,
  saved,
  takeAlong,
  undo,
  valuesOf,
} from "./gesture-draft.js";
import { switches, textProblem, texts } from "./gesture-form.js";
import { mayLeave } from "./leave-dialog.js";
import { previewing } from "./preview-requests.js";
import { health, image } from "./preview-results.js";
import { keypoints, toggle } from "./salient-keypoints.js";

/** @import { Gesture, Language, Outlook, Preview } from "../core/types.d.ts" */

/**
 * The gesture that is edited; `gesture` is null for a new one.
 *
 * @typedef {{ language: Language, gesture: string | null, key: string }} Subject
 */

const GROUP = "Editing a gesture";

/**
 * What is on display, beside the draft.
 *
 * @typedef {object} Editor
 * @property {Subject} about
 * @property {boolean} drawn whether only the drawing of the gesture is known
 * @property {ReturnType<typeof take>} take
 * @property {ReturnType<typeof previewing>} ask
 * @property {{ all: boolean, refused: boolean }} listed which keypoints are listed
 * @property {Preview | null} preview
 * @property {string | null} drawing the newest image
 * @property {Outlook | null} estimate
 * @property {Outlook | null} newest the newest estimate, possibly of an earlier draft
 * @property {Outlook | null} before the estimate of what is saved
 * @property {number | null} kept when the draft was left that is restored, in ms
 * @property {string} problem why it was not saved
 */

/** @type {Editor | null} */
let editor = null;

/** @type {HTMLElement} */
let root;

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

/** @param {Subject} about */
const othersOf = ({ gesture }) =>
  currentLanguage()
    .gestures.map((each) => each.label)
    .filter((label) => label !== (gesture ?? draft().label.trim()));

/**
 * The gesture of which a new range would be a further demonstration, or null.
 *
 * @param {Subject} about
 */
const furtherTo = ({ gesture }) =>
  gesture === null ? knownLabel(currentLanguage(), draft()) : null;

/** @param {Editor} shown */
function actions({ about }) {
  const { gesture } = about;
  const more = furtherTo(about);
  const idle =
    isSaving ||
    (gesture !== null && !isChanged()) ||
    textProblem(draft(), othersOf(about))?.id === "editor-label";
  const saves = gesture === null ? (more ? `Add to ${more}` : "Save gesture") : "Save";
  return html`<div class="editor-actions">
    <button type="button" title="Undo (Ctrl+Z)" ?disabled=${!canUndo()} @click=${undo}>Undo</button>
    <button type="button" title="Redo (Ctrl+Shift+Z)" ?disabled=${!canRedo()} @click=${redo}>
      Redo
    </button>
    <button type="button" title="Back without saving" @click=${leave}>Cancel</button>
    <button type="submit" class="primary" data-writes ?disabled=${idle}>${saves}</button>
  </div>`;
}

/** @param {Editor} shown */
const restored = ({ kept }) =>
  html`<p class="restored" role="status" ?hidden=${kept === null}>
    A draft that was not saved, last changed ${kept && ago(kept)}, is restored.
    ${buttonOf("Discard the draft", discard, {
      title: "Go back to what is saved; Undo brings the draft back",
    })}
  </p>`;

/** @param {Editor} shown */
function page(shown) {
  const { about, preview, estimate, newest, before } = shown;
  const { gesture, language } = about;
  const stand = isChanged() ? "Draft, not saved yet" : gesture === null ? "" : "As saved";
  const outlooks = { found: estimate, newest, before, problem: preview?.problem };
  return html`<form class="editor-page" novalidate @submit=${submit}>
    <div class="page-head">
      <h1>${gesture === null ? "New gesture" : `Edit ${gesture}`}</h1>
      <span class="dim in-language">in ${language.name}</span>
      <span class="draft-state dim" role="status">${stand}</span>
      <span class="spacer"></span>
      ${actions(shown)}
    </div>
    ${restored(shown)}
    <p class="field-problem" role="alert" ?hidden=${!shown.problem}>${shown.problem}</p>
    <div class="editor-grid">
      <div class="column">${shown.take.element}${keypoints(preview, shown.listed, draw)}</div>
      <div class="column">${image(preview, shown.drawing)}${health(language.name, outlooks)}</div>
      <div class="column">${texts(othersOf(about))}${switches(estimate)}</div>
    </div>
  </form>`;
}

function draw() {
  if (!editor) return;
  if (!isChanged()) editor.kept = null;
  render(page(editor), root);
  editor.take.draw(editor.preview);
}

/** Draw the draft after a change, and request its preview. */
function changed() {
  if (!editor) return;
  const { about, drawn, ask } = editor;
  editor.problem = "";
  draw();
  const more = furtherTo(about);
  const request = requestOf(about.gesture, draft(), saved(), drawn && !draft().clip);
  ask(about.language.id, more ? { label: more, change: furtherOf(draft()) } : request);
}

/**
 * @param {Editor} shown the one that asked, which may be closed by now
 * @param {Preview} found
 * @param {Outlook | null} estimate
 */
function showPreview(shown, found, estimate) {
  if (editor !== shown) return;
  if (estimate && !isChanged() && shown.about.gesture !== null) shown.before = estimate;
  Object.assign(shown, { preview: found, estimate });
  shown.newest = estimate ?? shown.newest;
  shown.drawing = found.image || shown.drawing;
  draw();
}

/** @param {string} landmark */
function pick(landmark) {
  if (!toggle(landmark, editor?.preview ?? null))
    toast("One keypoint stays", "At least one keypoint is followed; choose another one first.");
}

/** @param {Subject} about */
function build(about) {
  const { language, gesture } = about;
  const drawn = gesture !== null && !gestureOf(about).has_trajectory;
  const place = placeOf(language.id, gesture ?? `new ${state.clip}`);
  const kept = begin(place, valuesOf(about), changed);
  /** @type {Editor} */
  const shown = {
    about,
    drawn,
    take: take({ language: language.id, gesture, drawn, pick }),
    ask: previewing({
      shown: (found, estimate) => showPreview(shown, found, estimate),
      failed: (error) => complain(error, "The preview"),
    }),
    listed: { all: false, refused: false },
    preview: null,
    drawing: null,
    estimate: null,
    newest: null,
    before: null,
    kept,
    problem: "",
  };
  editor = shown;
  render("", root); // Nothing of another gesture stays, such as what is unfolded.
  // The clip of a kept draft may have been deleted.
  if (draft().clip && !isThere(draft().clip)) change({ clip: saved().clip });
  changed();
  if (gesture !== null) return;
  // A proposed label is replaced by typing.
  byId("editor-label").focus({ preventScroll: true });
  byId("editor-label").select();
}

function abandon() {
  forget();
  close();
  return leave();
}

/** @param {SubmitEvent} event */
async function submit(event) {
  event.preventDefault();
  if (!editor) return;
  const { about, preview } = editor;
  const fault = textProblem(draft(), othersOf(about));
  if (fault) {
    showProblem(fault.text);
    byId(fault.id)?.focus();
    return;
  }
  isSaving = true;
  draw();
  try {
    const label = draft().label.trim();
    const more = furtherTo(about);
    const now = await save(about.language, about.gesture, draft(), saved());
    await abandon();
    const shown = preview?.strokes ? `: ${preview.strokes}` : `, in ${now.name}`;
    showDone(more ? "Demonstration added" : "Gesture saved", label + shown);
    focusCard(more || label);
  } catch (error) {
    if (error.code !== "cancelled") showProblem(error.message);
    else abandon(); // The user kept somebody else's edit.
  } finally {
    isSaving = false;
    draw();
  }
}

/** @param {string} text */
function showProblem(text) {
  if (editor) editor.problem = text;
  draw();
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

function explain() {
  const { gestures, gesture } = state;
  const missing = gestures && gesture && !gestures.gestures.some((each) => each.label === gesture);
  render(
    html`<div class="editor-empty">
      <h1>${missing ? `There is no gesture \u201c${gesture}\u201d` : "No gesture is chosen"}</h1>
      <p class="dim">
        ${
          missing
            ? `\u201c${gestures.name}\u201d has none of that label (any more); it may have been renamed or deleted.`
            : "Choose a gesture of the language, or a take of a clip to make one of."
        }
      </p>
      <button type="button" class="primary" @click=${leave}>Back to the studio</button>
    </div>`,
    root,
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
  root = section;
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
        if (nothingComes()) explain();
        return undefined;
      }
      if (edited?.key === about.key) return adopt(edited, about);
      left();
      return build(about);
    },
  );
  // The server is back: repeat the requests that failed meanwhile.
  follow(["returns"], () => changed());
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
