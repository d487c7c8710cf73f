// The table of all takes of clips: recognised at once, sorted, filtered, and saved as CSV.

import { demonstratedBy } from "../clips/demonstration-ranges.js";
import { olderClipsButton } from "../clips/older-clips.js";
import { saveFile } from "../clips/mcap-export.js";
import { select } from "../clips/clip-store.js";
import { takeRow, takesTable } from "../clips/takes.js";
import * as api from "../core/api.js";
import { closeDialog, showDialog } from "../core/dialogs.js";
import { byId, h } from "../core/dom.js";
import { moment, percent, plural, timeLeft } from "../core/format.js";
import { follow, state, update } from "../core/state.js";
import { buttonOf, html, live, optionsOf, progressBar, render } from "../templates.js";
import { shownRows, sortedRows } from "./take-rows.js";

/** @import { State, TakeRow, TakeTable } from "../core/types.d.ts" */

/** @type {[string, keyof TakeRow][]} */
const COLUMNS = [
  ["Clip", "clip"],
  ["Start", "start"],
  ["End", "end"],
  ["Label", "label"],
  ["Confidence", "confidence"],
  ["Runner-up", "runner_up"],
  ["Expected", "expected"],
  ["Faults", "faults"],
];

/**
 * Show the button as soon as there are takes to recognise.
 *
 * @param {State} state
 */
export function drawTakesButton({ clips, gestures }) {
  byId("all-takes").hidden =
    !gestures?.gestures.length || !clips.some(({ status }) => status === "done");
}

/**
 * Show a take in the studio, with its votes and explanation.
 *
 * @param {TakeRow} row
 */
function jump(row) {
  closeDialog();
  select(row.clip_id);
  update({ take: row.take === null ? null : row.take - 1, start: null, end: null });
}

/**
 * Whether a take was recognised as expected, and if not, what was expected.
 *
 * @param {TakeRow} row
 */
function verdictOf({ take, label, pair, expected }) {
  if (expected === null) return "";
  if (take === null || label === expected) return "yes";
  return `${pair ? "asked" : "no"}: ${expected}`;
}

/** @param {TakeRow} row */
function cellsOf(row) {
  const name = row.take === null ? row.clip : `${row.clip}, take ${row.take}`;
  const answer = row.pair ? `${row.pair}?` : `rejected, nearest ${row.nearest}`;
  const own = demonstratedBy(state.gestures?.gestures ?? [], row);
  return [
    buttonOf(name, () => jump(row), { look: "link", title: "Show in the studio" }),
    row.start === null ? "" : moment(row.start),
    row.end === null ? "" : moment(row.end),
    row.take === null ? "" : (row.label ?? answer) + (own ? " (demonstration)" : ""),
    row.confidence === null ? "" : percent(row.confidence),
    row.runner_up ?? "",
    verdictOf(row),
    row.faults,
  ];
}

/**
 * What the dialog shows: the choice of clips, then the progress of the table that is made, then the
 * table in its order. `ticks` are the clips that are chosen otherwise than `every` one.
 *
 * @typedef {{ ticks: Map<string, boolean>, every: boolean, id: string, problem: string, table: TakeTable | null, filter: string, by: keyof TakeRow | null, down: boolean }} Shown
 * @typedef {(change: Partial<Shown>) => void} Put
 */

/**
 * The table with its filter, its order and its export.
 *
 * @param {TakeTable} table
 * @param {Shown} shown
 * @param {Put} put
 */
function result({ rows, csv }, { filter, by, down }, put) {
  const labels = [...new Set(rows.flatMap(({ label }) => label ?? []))].sort();
  /** @type {[string, string][]} */
  const filters = [
    ["", "All takes"],
    ["rejected", "Rejected"],
    ["asked", "Asked back"],
    ["faults", "With faults"],
    ...labels.map((label) => /** @type {[string, string]} */ ([`=${label}`, label])),
  ];
  const file = () => ({ name: "takes.csv", content: new Blob([csv], { type: "text/csv" }) });
  const head = (/** @type {typeof COLUMNS[number]} */ [title, name]) => {
    const order = name !== by ? "none" : down ? "descending" : "ascending";
    const sort = () => put({ by: name, down: name === by && !down });
    return html`<th scope="col" aria-sort=${order}>${buttonOf(title, sort, { look: "link" })}</th>`;
  };
  const kept = sortedRows(shownRows(rows, filter), by, down);
  return html`<div class="take-tools">
      <label for="take-filter">Show</label>
      <select
        id="take-filter"
        @change=${(/** @type {any} */ { target }) => put({ filter: target.value })}
      >
        ${optionsOf(filters, filter)}
      </select>
      <span class="dim" role="status">${kept.length} of ${plural(rows.length, "row")}</span>
      <span class="spacer"></span>
      ${buttonOf("Export as CSV", () => saveFile(file()), {
        title: "All rows, in the order of the clips",
      })}
    </div>
    <div class="table-scroll" tabindex="0" role="region" aria-label="Table of takes">
      ${takesTable(
        "Takes",
        COLUMNS.map(head),
        kept.map((row) => takeRow(cellsOf(row))),
      )}
    </div>`;
}

const ready = () => state.clips.filter(({ status }) => status === "done");

/**
 * The clips to choose from; all are chosen at first.
 *
 * @param {Shown} shown
 * @param {Put} put
 * @param {HTMLElement} olderClips
 */
function clipChoice({ ticks, every }, put, olderClips) {
  const box = (/** @type {boolean} */ checked, /** @type {(on: boolean) => void} */ set) =>
    html`<input
      type="checkbox"
      .checked=${live(checked)}
      @change=${(/** @type {any} */ { target }) => set(target.checked)}
    />`;
  const clips = ready();
  return html`<fieldset class="take-clips">
    <legend>Clips</legend>
    <label
      >${box(every, (on) => put({ every: on, ticks: new Map() }))}<b
        >All ${plural(clips.length, "clip")}</b
      ></label
    >
    <div class="take-clip-rows">
      ${clips.map(
        ({ id, name }) =>
          html`<label>${box(ticks.get(id) ?? every, (on) => ticks.set(id, on))}${name}</label>`,
      )}
    </div>
    ${olderClips}
  </fieldset>`;
}

/** How far the table is that is made. */
function progress(/** @type {string} */ id) {
  const told = state.tabling?.id === id ? state.tabling : null;
  const rest = told && told.eta_s !== null ? `, ${timeLeft(told.eta_s)}` : "";
  const far = told ? ` ${told.stage}, ${percent(told.done / told.total)}${rest}` : "";
  return html`<p role="status">Recognising${far}</p>
    ${progressBar("Progress of the table", told?.done, told?.total)}`;
}

let redraw = () => {};

/** Open the dialog that recognises all takes. */
export function openTakeTable() {
  const language = state.gestures;
  if (!language) return;
  const leaving = new AbortController();
  const form = h("form", { method: "dialog", className: "take-table", noValidate: true });
  const olderClips = olderClipsButton(() => draw());
  /** @type {Shown} */
  const shown = {
    ticks: new Map(),
    every: true,
    id: "",
    problem: "",
    table: null,
    filter: "",
    by: null,
    down: false,
  };
  /** @type {Put} */
  const put = (change) => {
    Object.assign(shown, change);
    draw();
  };
  const recognise = async () => {
    const clips = ready().filter(({ id }) => shown.ticks.get(id) ?? shown.every);
    if (!clips.length)
      return put({ problem: "No clip is chosen; choose one whose takes are recognised." });
    const id = api.uniqueId();
    put({ id, problem: "" });
    try {
      const wanted = { id, clip_ids: clips.map((clip) => clip.id) };
      put({ table: await api.languages.takeTable(language.id, wanted, leaving.signal) });
    } catch (error) {
      put({ problem: `The takes could not be recognised: ${error.message}` });
    }
    return put({ id: "" });
  };
  const draw = () => {
    const { id, problem, table } = shown;
    const choosing = !id && !table;
    render(
      html`<h2 id="dialog-title">All takes, recognised by ${language.name}</h2>
        <div class="take-content">
          ${
            table
              ? result(table, shown, put)
              : id
                ? progress(id)
                : clipChoice(shown, put, olderClips)
          }
          <p class="field-problem" role="alert" ?hidden=${!problem}>${problem}</p>
        </div>
        <div class="dialog-actions">
          ${buttonOf(id ? "Cancel" : "Close", closeDialog)}
          <button type="submit" class="primary" ?hidden=${!choosing}>Recognise all takes</button>
        </div>`,
      form,
    );
  };
  form.onsubmit = (event) => {
    event.preventDefault();
    if (!shown.id && !shown.table) recognise();
  };
  redraw = draw;
  draw();
  showDialog(form, () => leaving.abort());
  /** @type {HTMLElement | null} */ (form.querySelector("[type=submit]"))?.focus();
}

follow(["tabling"], () => redraw());
