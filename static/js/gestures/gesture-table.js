// The table that makes gestures of several clips: named in one place, saved in one undoable step.

import { BUSY } from "../clips/busy.js";
import { labelInName } from "../clips/clip-label.js";
import { olderClipsButton } from "../clips/older-clips.js";
import { heldName } from "../clips/salutes.js";
import { addedAt, posterOf, statusText } from "../clips/clip-store.js";
import * as api from "../core/api.js";
import { tabStore } from "../core/browser-store.js";
import { byId, h, reconcile, WRITES } from "../core/dom.js";
import { plural } from "../core/format.js";
import { follow, state } from "../core/state.js";
import { limit } from "../core/text-limit.js";
import { complain } from "../core/toasts.js";
import { showDone } from "../core/undo.js";
import { begin, choose } from "../languages/language-store.js";
import { edit } from "../languages/revision-edit.js";
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
 * The table on display; `edited` is what the user chose, `refused` what the server
 * refused, both by row. `readings` are what the language `reads` in takes that have a name of it.
 *
 * @typedef {object} Table
 * @property {HTMLElement} list
 * @property {HTMLElement} note
 * @property {ReturnType<typeof bestChoice>} best
 * @property {HTMLButtonElement} save
 * @property {HTMLInputElement} name of the new language
 * @property {string} target the language to save into; empty for a new one
 * @property {Map<string, Partial<GestureRow>>} edited
 * @property {Map<string, string>} refused
 * @property {Map<string, TakeRow>} readings
 * @property {string} reads
 * @property {AbortController} leaving
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
const isOpen = () => Boolean(table?.list.isConnected && byId("dialog").open);
let followed = false;
let drawing = false;

/** The language to save into; null for a new one. */
const targetLanguage = () => (state.gestures?.id === onDisplay().target ? state.gestures : null);

/** The clips from which gestures can be made, now or as soon as their poses are found. */
const usable = () => state.clips.filter(({ status }) => status === "done" || BUSY.has(status));

/**
 * Show the button that opens the table; it is highlighted while several clips show no gesture and
 * none on display can be recognised: one button of a screen stands out.
 *
 * @param {State} state
 */
export function drawTableButton({ gestures, clip }) {
  const button = byId("make-gestures");
  const clips = usable();
  button.hidden = !clips.length;
  const recognisable =
    gestures?.gestures.length && clips.some(({ id, status }) => id === clip && status === "done");
  const unused = withoutGesture(clips, gestures).length > 1;
  button.classList.toggle("primary", unused && !recognisable);
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
  tabStore.write(KEPT, { edited: [...edited], name: name.value, target });
}

/** @param {GestureRow} row */
function makeRow(row) {
  const { key, clip } = row;
  const box = h("input", {
    type: "checkbox",
    "aria-label": `Make a gesture of ${clip.name}`,
    onchange: () => change(key, { chosen: box.checked }),
  });
  const label = h("input", {
    type: "text",
    className: "row-label",
    autocomplete: "off",
    "aria-label": `Label of ${clip.name}`,
    "aria-describedby": `row-note-${key.replace(" ", "-")}`,
    oninput: () => change(key, { label: label.value, chosen: true }),
  });
  return h(
    "li",
    { className: "gesture-row" },
    box,
    posterOf(clip),
    h("div", { className: "row-clip" }, h("b", {}, clip.name), h("span", { className: "dim num" })),
    limit(label, LONGEST_LABEL),
    h("p", { className: "row-note", id: `row-note-${key.replace(" ", "-")}` }),
  );
}

/**
 * Write what changed into a row; the field that is being typed in keeps its text and focus.
 *
 * @param {GestureRow} row
 * @param {string | undefined} problem
 * @param {HTMLElement | undefined} element
 */
function drawRow(row, problem, element) {
  const drawn = element ?? makeRow(row);
  const [box, label] = drawn.querySelectorAll("input");
  const [range, note] = [".row-clip span", ".row-note"].map((each) => drawn.querySelector(each));
  if (!range || !note) return drawn;
  box.checked = row.chosen;
  if (label.value !== row.label) label.value = row.label;
  label.setAttribute("aria-invalid", String(Boolean(problem)));
  drawn.classList.toggle("left-out", !row.chosen);
  range.textContent = row.takes
    ? [rangeText(row), addedAt(row.clip)].filter(Boolean).join(" \u00b7 ")
    : statusText(row.clip, state.jobs.get(row.clip.job_id));
  const warning = row.chosen ? rangeWarning(row, heldName(state.gestures)) : "";
  note.textContent = (row.chosen && problem) || warning || row.why || furtherNote(row);
  note.classList.toggle("problem", Boolean(row.chosen && problem));
  return drawn;
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
  const { best, list, name, note: line, refused, save: button, saving, target } = table;
  const all = rows();
  const { problems, note } = problemsOf(all);
  reconcile(
    list,
    all,
    ({ key }) => key,
    (row, element) => drawRow(row, refused.get(row.key) ?? problems.get(row.key), element),
  );
  best.draw(candidatesOf(all).length);
  const chosen = all.filter((row) => row.chosen);
  const unnamed = target === NEW && !name.value.trim();
  line.textContent = unnamed ? "The new language has no name." : note;
  button.textContent = `Save ${countOf(chosen.map(({ further }) => Boolean(further)))}`;
  button.disabled = Boolean(saving || note || unnamed);
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

/** The controls that leave the best rows selected, and tell by whose demonstrations. */
function bestChoice() {
  const count = h("input", { type: "number", min: "1", "aria-label": "Rows to keep" });
  const of = h("span");
  const note = h("p", { className: "dim", role: "status" });
  const button = h("button", { type: "button" }, "Keep the best");
  const element = h("div", { className: "keep-best" }, button, count, of, note);
  let asking = false;
  let typed = false;
  count.oninput = () => {
    typed = true;
  };
  /** @param {number} size of the rows among which is chosen */
  const draw = (size) => {
    element.hidden = size < 2 || size > MOST_COMPARED;
    of.textContent = `of ${size}`;
    count.max = String(size);
    if (!typed) count.value = String(Math.round(0.6 * size));
    button.disabled = asking;
  };
  button.onclick = async () => {
    const shown = onDisplay();
    const among = candidatesOf(rows());
    const keep = Math.min(Math.max(1, Math.round(Number(count.value))), among.length);
    count.value = String(keep);
    const takes = {
      keep,
      language_id: shown.target === NEW ? null : shown.target,
      gestures: among.map((row) => ({
        ...draftOf(row),
        label: (row.label.trim() || row.clip.name).slice(0, LONGEST_LABEL),
      })),
    };
    asking = typed = true;
    note.textContent = "Comparing the takes.";
    draw(among.length);
    try {
      const choice = await api.languages.choose(takes, shown.leaving.signal);
      for (const [key, values] of choiceOf(among, choice))
        shown.edited.set(key, { ...shown.edited.get(key), ...values });
      remember();
      note.textContent = choice.people;
    } catch (error) {
      note.textContent = "";
      if (!shown.leaving.signal.aborted) refuse(shown, among, error, "Choosing the best");
    } finally {
      asking = false;
      drawSoon();
    }
  };
  return { element, draw };
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
    if (shown.target === NEW) await saveIntoNew(shown.name.value.trim(), drafts);
    else await saveInto(shown.target, drafts);
    tabStore.set(KEPT, null);
    byId("dialog").close();
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

/** The choice of the language: one's own, or a new one. Samples stay as they are. */
function languageChoice() {
  const own = state.languages.filter(({ sample }) => !sample);
  const kept = tabStore.read(KEPT);
  const name = h("input", {
    type: "text",
    id: "table-name",
    value: kept?.name ?? PROPOSED_NAME,
    autocomplete: "off",
    oninput: () => {
      remember();
      draw();
    },
  });
  limit(name, LONGEST_NAME);
  const nameRow = h(
    "div",
    { className: "field" },
    h("label", { for: "table-name" }, "Name of the new language"),
    name,
  );
  const select = h(
    "select",
    { id: "table-language" },
    own.map((each) => h("option", { value: each.id }, each.name)),
    h("option", { value: NEW }, "A new language"),
  );
  const first = own.find(({ id }) => id === (kept?.target ?? state.language));
  select.value = kept?.target === NEW ? NEW : (first?.id ?? NEW);
  select.onchange = async () => {
    onDisplay().target = select.value;
    nameRow.hidden = select.value !== NEW;
    remember();
    if (select.value !== NEW) await choose(select.value);
    draw();
    read();
  };
  nameRow.hidden = select.value !== NEW;
  const element = h(
    "div",
    { className: "table-language" },
    h("div", { className: "field" }, h("label", { for: "table-language" }, "Save into"), select),
    nameRow,
  );
  return { element, name, target: select.value, edited: new Map(kept?.edited) };
}

function cancel() {
  tabStore.set(KEPT, null);
  byId("dialog").close();
}

/** Open the table with the clips of the library. */
export function openGestureTable() {
  const dialog = byId("dialog");
  const { element, name, target, edited } = languageChoice();
  const note = h("p", { className: "dim", role: "status" });
  const list = h("ul", { className: "gesture-rows", "aria-label": "Gestures to save" });
  const best = bestChoice();
  const button = h("button", { type: "submit", className: "primary", ...WRITES });
  table = {
    best,
    list,
    note,
    save: button,
    name,
    target,
    edited,
    refused: new Map(),
    readings: new Map(),
    reads: "",
    leaving: new AbortController(),
    saving: false,
  };
  const form = h(
    "form",
    { method: "dialog", className: "gesture-table", noValidate: true },
    h("h2", { id: "dialog-title" }, "Make gestures of these clips"),
    h(
      "p",
      { className: "dim" },
      `Each take between two ${heldName(state.gestures)}s becomes one gesture, under the name beside it, or a further demonstration of one that the language has.`,
    ),
    element,
    list,
    olderClipsButton(),
    best.element,
    h(
      "div",
      { className: "dialog-actions" },
      note,
      h("span", { className: "spacer" }),
      h("button", { type: "button", onclick: cancel }, "Cancel"),
      button,
    ),
  );
  form.onsubmit = (event) => {
    event.preventDefault();
    if (!button.disabled) save();
  };
  dialog.replaceChildren(form);
  dialog.setAttribute("aria-labelledby", "dialog-title");
  const { leaving } = table;
  dialog.onclose = () => leaving.abort();
  dialog.showModal();
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
  /** @type {HTMLElement | null} */ (list.querySelector(".row-label"))?.focus();
}
