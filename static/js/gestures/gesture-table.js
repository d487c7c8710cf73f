// The table that makes gestures of several clips: named in one place, saved in one undoable step.

import { BUSY } from "../clips/batch.js";
import { labelInName } from "../clips/clip-label.js";
import { olderClipsButton } from "../clips/older-clips.js";
import { heldName } from "../clips/salutes.js";
import { addedAt, posterOf, statusText } from "../clips/clip-store.js";
import * as api from "../core/api.js";
import { tabStore } from "../core/browser-store.js";
import { closeDialog, showDialog } from "../core/dialogs.js";
import { byId, h } from "../core/dom.js";
import { plural } from "../core/format.js";
import { follow, state } from "../core/state.js";
import { complain } from "../core/toasts.js";
import { showDone } from "../core/undo.js";
import { begin, choose } from "../languages/language-store.js";
import { edit } from "../languages/revision-edit.js";
import { guard, html, limited, live, optionsOf, render, repeat } from "../templates.js";
import { forgetFailures, loadTakesOfClips, takesByClip } from "./clip-takes.js";
import {
  candidatesOf,
  choiceOf,
  furtherNote,
  problemsOf,
  rangeText,
  rangeWarning,
  readingAt,
  rowsOf,
  withoutGesture,
} from "./gesture-rows.js";

/** @import { GestureRow, Language, State, TakeRow } from "../core/types.d.ts" */

/**
 * The table on display; `edited` is what the user chose, `refused` what the server refused, both by
 * row. `readings` are what the language `reads` in takes that have a name of it. `keep` is the
 * number of rows to keep, once one is chosen, and `kept` tells by whose demonstrations they were.
 *
 * @typedef {object} Table
 * @property {HTMLFormElement} form
 * @property {HTMLElement} older
 * @property {string} name of the new language
 * @property {string} target the language to save into; empty for a new one
 * @property {Map<string, Partial<GestureRow>>} edited
 * @property {Map<string, string>} refused
 * @property {Map<string, TakeRow>} readings
 * @property {string} reads
 * @property {AbortController} leaving
 * @property {string | null} keep
 * @property {string} kept
 * @property {boolean} comparing
 * @property {boolean} saving
 */

const NEW = "";
const KEPT = "gesture-table"; // what the user wrote and chose, until it is saved or cancelled
const PROPOSED_NAME = "My gestures";
const LONGEST_LABEL = 80;
const MOST_READ = 100; // clips whose takes are read: some seconds
const LONGEST_NAME = 80;
const MOST_COMPARED = 64; // rows of one choice

/** @type {Table | null} */
let table = null;

/** The table, for code that runs only while it is on display. */
const onDisplay = () => /** @type {Table} */ (table);
const isOpen = () => Boolean(table?.form.isConnected && byId("dialog").open);
let followed = false;
let drawing = false;

/** The language to save into; null for a new one. */
const targetLanguage = () => (state.gestures?.id === onDisplay().target ? state.gestures : null);

/** The clips from which gestures can be made, now or as soon as their poses are found. */
const usable = () => state.clips.filter(({ status }) => status === "done" || BUSY.has(status));

/**
 * Show the button that opens the table. The next step stands out: this button while several clips
 * of the user's own show no gesture and a language of the user's own cannot recognise the clip on
 * display, else *Recognise*.
 *
 * @param {State} state
 */
export function drawTableButton({ gestures, clip, samples, loaded }) {
  const button = byId("make-gestures");
  const clips = usable();
  button.hidden = !loaded || !clips.length;
  const recognisable =
    gestures?.gestures.length &&
    !gestures.sample &&
    clips.some(({ id, status }) => id === clip && status === "done");
  const own = clips.filter(({ name }) => !samples.some((sample) => sample.name === name));
  const isNext = withoutGesture(own, gestures).length > 1 && !recognisable;
  button.classList.toggle("primary", isNext);
  byId("recognise").classList.toggle("primary", !isNext);
}

const rows = () =>
  rowsOf(usable(), takesByClip, targetLanguage(), onDisplay().edited, onDisplay().readings);

/** Read the takes whose expected gesture the language has, so that those it reads are left out. */
async function read() {
  const language = targetLanguage();
  if (!table || !isOpen() || !language) return;
  const tested = new Set(state.testSet?.takes.map(({ clip_id: clip }) => clip));
  const clips = withoutGesture(usable(), language)
    .filter(({ status }) => status === "done")
    .filter(({ id, name }) => tested.has(id) || labelInName(name, language.labels))
    .slice(0, MOST_READ)
    .map(({ id }) => id);
  const reads = [language.id, language.revision, ...clips].join(" ");
  if (!clips.length || table.reads === reads) return;
  table.reads = reads;
  const asked = table;
  const { signal } = asked.leaving;
  const found = await api.languages
    .takeTable(language.id, { id: api.uniqueId(), clip_ids: clips }, signal)
    .catch(() => null);
  if (!found || asked.reads !== reads) return;
  asked.readings = new Map(
    found.rows.map((row) => [readingAt(row.clip_id, (row.take ?? 1) - 1), row]),
  );
  draw();
}

/**
 * @param {string} key
 * @param {Partial<GestureRow>} values
 */
function change(key, values) {
  const { edited, refused } = onDisplay();
  edited.set(key, { ...edited.get(key), ...values });
  refused.delete(key);
  remember();
  draw();
}

/** Keep what the user wrote and chose over a reload. */
function remember() {
  const { edited, name, target } = onDisplay();
  tabStore.write(KEPT, { edited: [...edited], name, target });
}

/**
 * @param {GestureRow} row
 * @param {string | undefined} problem
 */
function rowOf(row, problem) {
  const { key, clip, chosen, label } = row;
  const range = row.takes
    ? [rangeText(row), addedAt(clip)].filter(Boolean).join(" \u00b7 ")
    : statusText(clip, state.jobs.get(clip.job_id));
  const warning = chosen ? rangeWarning(row, heldName(state.gestures)) : "";
  const note = `row-note-${key.replace(" ", "-")}`;
  const fault = chosen && problem;
  const words = fault || warning || row.why || furtherNote(row);
  return html`<li class="gesture-row ${chosen ? "" : "left-out"}">
    <input
      type="checkbox"
      aria-label="Make a gesture of ${clip.name}"
      .checked=${live(chosen)}
      @change=${(/** @type {any} */ { target }) => change(key, { chosen: target.checked })}
    />${guard([clip.id, clip.status], () => posterOf(clip))}
    <div class="row-clip"><b>${clip.name}</b><span class="dim num">${range}</span></div>
    <input
      type="text"
      class="row-label"
      autocomplete="off"
      aria-label="Label of ${clip.name}"
      aria-describedby=${note}
      aria-invalid=${Boolean(problem)}
      .value=${live(label)}
      ${limited(LONGEST_LABEL)}
      @input=${(/** @type {any} */ { target }) =>
        change(key, { label: target.value, chosen: true })}
    />
    <p class="row-note ${fault ? "problem" : ""}" id=${note} ?hidden=${!words}>${words}</p>
  </li>`;
}

/** Draw once for all changes before the next repaint. */
function drawSoon() {
  if (drawing) return;
  drawing = true;
  requestAnimationFrame(() => {
    drawing = false;
    draw();
  });
}

function draw() {
  if (!table || !isOpen()) return;
  const { name, refused, saving, target, older } = table;
  const all = rows();
  const { problems, note } = problemsOf(all);
  const chosen = all.filter((row) => row.chosen);
  const unnamed = target === NEW && !name.trim();
  render(
    html`<h2 id="dialog-title">Make gestures of these clips</h2>
      <p class="dim">
        Each take between two ${heldName(state.gestures)}s becomes one gesture, under the name
        beside it, or a further demonstration of one that the language has.
      </p>
      ${languageChoice()}
      <ul class="gesture-rows" aria-label="Gestures to save">
        ${repeat(
          all,
          ({ key }) => key,
          (row) => rowOf(row, refused.get(row.key) ?? problems.get(row.key)),
        )}
      </ul>
      ${older}${bestChoice(candidatesOf(all))}
      <div class="dialog-actions">
        <p class="dim" role="status">${unnamed ? "The new language has no name." : note}</p>
        <span class="spacer"></span>
        <button type="button" @click=${cancel}>Cancel</button>
        <button type="submit" class="primary" data-writes ?disabled=${saving || note || unnamed}>
          Save ${countOf(chosen.map(({ further }) => Boolean(further)))}
        </button>
      </div>`,
    table.form,
  );
}

/**
 * Gestures and demonstrations in words.
 *
 * @param {boolean[]} further whether each is a further demonstration
 */
function countOf(further) {
  const more = further.filter(Boolean).length;
  const fresh = further.length - more;
  const parts = [plural(fresh, "gesture"), plural(more, "demonstration")];
  return parts.filter((_, index) => (index ? more : fresh || !more)).join(" and ");
}

/**
 * The number of rows to keep: as chosen, or three of five.
 *
 * @param {GestureRow[]} among
 */
const keepOf = (among) => onDisplay().keep ?? String(Math.round(0.6 * among.length));

/**
 * The controls that leave the best rows selected, and tell by whose demonstrations.
 *
 * @param {GestureRow[]} among
 */
function bestChoice(among) {
  const { kept, comparing } = onDisplay();
  const type = (/** @type {any} */ { target }) => {
    onDisplay().keep = target.value;
  };
  return html`<div class="keep-best" ?hidden=${among.length < 2 || among.length > MOST_COMPARED}>
    <button type="button" ?disabled=${comparing} @click=${keepBest}>Keep the best</button>
    <input
      type="number"
      min="1"
      max=${among.length}
      aria-label="Rows to keep"
      .value=${live(keepOf(among))}
      @input=${type}
    /><span>of ${among.length}</span>
    <p class="dim" role="status">${kept}</p>
  </div>`;
}

async function keepBest() {
  const shown = onDisplay();
  const among = candidatesOf(rows());
  const keep = Math.min(Math.max(1, Math.round(Number(keepOf(among)))), among.length);
  const takes = {
    keep,
    language_id: shown.target === NEW ? null : shown.target,
    gestures: among.map((row) => ({
      ...draftOf(row),
      label: (row.label.trim() || row.clip.name).slice(0, LONGEST_LABEL),
    })),
  };
  Object.assign(shown, { keep: String(keep), comparing: true, kept: "Comparing the takes." });
  draw();
  try {
    const choice = await api.languages.choose(takes, shown.leaving.signal);
    for (const [key, values] of choiceOf(among, choice))
      shown.edited.set(key, { ...shown.edited.get(key), ...values });
    remember();
    shown.kept = choice.people;
  } catch (error) {
    shown.kept = "";
    if (!shown.leaving.signal.aborted) refuse(shown, among, error, "Choosing the best");
  } finally {
    shown.comparing = false;
    drawSoon();
  }
}

/**
 * Show an error beside the row that it names, or as a message.
 *
 * @param {Table} shown
 * @param {GestureRow[]} asked
 * @param {any} error
 * @param {string} doing
 */
function refuse(shown, asked, error, doing) {
  const at = Number(/^\/gestures\/(\d+)/.exec(error.errors?.[0]?.pointer ?? "")?.[1] ?? Number.NaN);
  if (asked[at]) shown.refused.set(asked[at].key, error.message);
  else complain(error, doing);
}

/** @param {GestureRow} row */
const draftOf = ({ clip, take, label, further }) => ({
  label: further || label.trim(),
  clip_id: clip.id,
  ...(take ? { start: take.start, end: take.end } : {}),
});

/**
 * Save into a new language; if the gestures are refused, the language is removed again.
 *
 * @param {string} name
 * @param {ReturnType<typeof draftOf>[]} drafts
 */
async function saveIntoNew(name, drafts) {
  const made = await api.languages.create(name);
  try {
    const language = await api.languages.addGestures(made, drafts);
    await begin(language, `Creation of ${name}`, `${plural(drafts.length, "gesture")} saved`);
  } catch (error) {
    await api.languages.remove({ id: made.id });
    throw error;
  }
}

/**
 * Save gestures into a language, in one step that can be undone; those that it has get further
 * demonstrations.
 *
 * @param {string} id
 * @param {{ label: string, clip_id: string, start?: number, end?: number }[]} drafts
 */
export async function saveInto(id, drafts) {
  await choose(id);
  const known = new Set(state.gestures?.labels);
  const title = countOf(drafts.map(({ label }) => known.has(label)));
  await edit("Saving the gestures", `Addition of ${title}`, async (language) => {
    const fresh = drafts.filter(({ label }) => !known.has(label));
    let now = fresh.length ? await api.languages.addGestures(language, fresh) : language;
    for (const draft of drafts.filter(({ label }) => known.has(label)))
      now = await api.languages.addDemonstration(now, draft);
    return now;
  });
  showDone(`${title} saved`, drafts.map(({ label }) => label).join(", "));
}

async function save() {
  const chosen = rows().filter((row) => row.chosen);
  const drafts = chosen.map(draftOf);
  const shown = onDisplay();
  shown.saving = true;
  draw();
  try {
    if (shown.target === NEW) await saveIntoNew(shown.name.trim(), drafts);
    else await saveInto(shown.target, drafts);
    cancel();
  } catch (error) {
    refuse(
      shown,
      chosen.filter(({ further }) => !further),
      error,
      "Saving the gestures",
    );
  } finally {
    shown.saving = false;
    draw();
  }
}

const ownLanguages = () => state.languages.filter(({ sample }) => !sample);

/** The choice of the language: one's own, or a new one. Samples stay as they are. */
function languageChoice() {
  const { name, target } = onDisplay();
  const pick = async (/** @type {any} */ { target: { value } }) => {
    onDisplay().target = value;
    remember();
    if (value !== NEW) await choose(value);
    draw();
    read();
  };
  const rename = (/** @type {any} */ { target: { value } }) => {
    onDisplay().name = value;
    remember();
    draw();
  };
  /** @type {[string, string][]} */
  const options = ownLanguages().map((each) => [each.id, each.name]);
  return html`<div class="table-language">
    <div class="field">
      <label for="table-language">Save into</label>
      <select id="table-language" @change=${pick}>
        ${optionsOf([...options, [NEW, "A new language"]], target)}
      </select>
    </div>
    <div class="field" ?hidden=${target !== NEW}>
      <label for="table-name">Name of the new language</label>
      <input
        type="text"
        id="table-name"
        autocomplete="off"
        .value=${live(name)}
        ${limited(LONGEST_NAME)}
        @input=${rename}
      />
    </div>
  </div>`;
}

function cancel() {
  tabStore.set(KEPT, null);
  closeDialog();
}

/** Open the table with the clips of the library. */
export function openGestureTable() {
  const kept = tabStore.read(KEPT);
  const first = ownLanguages().find(({ id }) => id === (kept?.target ?? state.language));
  const leaving = new AbortController();
  const form = h("form", { method: "dialog", className: "gesture-table", noValidate: true });
  table = {
    form,
    older: olderClipsButton(),
    name: kept?.name ?? PROPOSED_NAME,
    target: kept?.target === NEW ? NEW : (first?.id ?? NEW),
    edited: new Map(kept?.edited),
    refused: new Map(),
    readings: new Map(),
    reads: "",
    leaving,
    keep: null,
    kept: "",
    comparing: false,
    saving: false,
  };
  form.onsubmit = (event) => {
    event.preventDefault();
    if (!onDisplay().saving) save();
  };
  showDialog(form, () => leaving.abort());
  forgetFailures();
  const load = () => {
    loadTakesOfClips(isOpen, drawSoon);
    read();
  };
  if (!followed) {
    followed = true;
    follow(["clips", "gestures", "returns"], load);
    follow(["clips", "jobs", "gestures"], draw);
  } else load();
  draw();
  /** @type {HTMLElement | null} */ (form.querySelector(".row-label"))?.focus();
}
