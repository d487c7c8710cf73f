// The table of all takes of clips: recognised at once, sorted, filtered, and saved as CSV.

import { demonstratedBy } from "../clips/demonstration-ranges.js";
import { olderClipsButton } from "../clips/older-clips.js";
import { saveFile } from "../clips/mcap-export.js";
import { select } from "../clips/clip-store.js";
import * as api from "../core/api.js";
import { closeDialog, showDialog } from "../core/dialogs.js";
import { byId, h } from "../core/dom.js";
import { moment, percent, plural, timeLeft } from "../core/format.js";
import { follow, state, update } from "../core/state.js";
import { shownRows, sortedRows } from "./take-rows.js";

/** @import { ExportProgress, State, TakeRow, TakeTable } from "../core/types.d.ts" */

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

/** @type {{ id: string, bar: HTMLProgressElement, words: HTMLElement } | null} */
let running = null;

/**
 * Show the button as soon as there are takes to recognise.
 *
 * @param {State} state
 */
export function drawTakesButton({ clips, gestures }) {
  byId("all-takes").hidden =
    !gestures?.gestures.length || !clips.some(({ status }) => status === "done");
}

/** @param {ExportProgress | null} progress */
function advance(progress) {
  if (!running || progress?.id !== running.id) return;
  const { stage, done, total, eta_s: left } = progress;
  const rest = left === null ? "" : `, ${timeLeft(left)}`;
  running.words.textContent = `Recognising ${stage}, ${percent(done / total)}${rest}`;
  Object.assign(running.bar, { max: total, value: done });
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
  const result = row.take === null ? "" : (row.label ?? answer) + (own ? " (demonstration)" : "");
  return [
    h(
      "button",
      { type: "button", className: "link", title: "Show in the studio", onclick: () => jump(row) },
      name,
    ),
    row.start === null ? "" : moment(row.start),
    row.end === null ? "" : moment(row.end),
    result,
    row.confidence === null ? "" : percent(row.confidence),
    row.runner_up ?? "",
    verdictOf(row),
    row.faults,
  ];
}

/**
 * The table with its filter, its order and its export.
 *
 * @param {TakeTable} table
 */
function resultOf({ rows, csv }) {
  let by = /** @type {keyof TakeRow | null} */ (null);
  let down = false;
  const labels = [...new Set(rows.flatMap(({ label }) => label ?? []))].sort();
  const filter = h(
    "select",
    { id: "take-filter" },
    h("option", { value: "" }, "All takes"),
    h("option", { value: "rejected" }, "Rejected"),
    h("option", { value: "asked" }, "Asked back"),
    h("option", { value: "faults" }, "With faults"),
    labels.map((label) => h("option", { value: `=${label}` }, label)),
  );
  const count = h("span", { className: "dim", role: "status" });
  const body = h("tbody");
  const heads = COLUMNS.map(([title, name]) => {
    const sort = () => {
      down = by === name && !down;
      by = name;
      draw();
    };
    return h(
      "th",
      { scope: "col" },
      h("button", { type: "button", className: "link", onclick: sort }, title),
    );
  });
  const draw = () => {
    const shown = sortedRows(shownRows(rows, filter.value), by, down);
    count.textContent = `${shown.length} of ${plural(rows.length, "row")}`;
    heads.forEach((head, at) => {
      const order = COLUMNS[at][1] === by ? (down ? "descending" : "ascending") : "none";
      head.setAttribute("aria-sort", order);
    });
    body.replaceChildren(
      ...shown.map((row) =>
        h(
          "tr",
          {},
          cellsOf(row).map((cell) => h("td", {}, cell)),
        ),
      ),
    );
  };
  filter.onchange = draw;
  draw();
  const file = () => ({ name: "takes.csv", content: new Blob([csv], { type: "text/csv" }) });
  return [
    h(
      "div",
      { className: "take-tools" },
      h("label", { for: "take-filter" }, "Show"),
      filter,
      count,
      h("span", { className: "spacer" }),
      h(
        "button",
        {
          type: "button",
          title: "All rows, in the order of the clips",
          onclick: () => saveFile(file()),
        },
        "Export as CSV",
      ),
    ),
    h(
      "div",
      { className: "table-scroll", tabIndex: 0, role: "region", "aria-label": "Table of takes" },
      h("table", {}, h("thead", {}, h("tr", {}, heads)), body),
    ),
  ];
}

/** The clips to choose from; all are chosen at first. */
function clipChoice() {
  /** @type {Map<string, HTMLInputElement>} */
  const boxes = new Map();
  const every = h("input", { type: "checkbox", checked: true });
  every.onchange = () => {
    for (const box of boxes.values()) box.checked = every.checked;
  };
  const words = h("b");
  const rows = h("div", { className: "take-clip-rows" });
  /** Offer the loaded clips; the choice among them stays. */
  const offer = () => {
    const ready = state.clips.filter(({ status }) => status === "done");
    for (const { id } of ready)
      if (!boxes.has(id))
        boxes.set(id, h("input", { type: "checkbox", value: id, checked: every.checked }));
    words.textContent = `All ${plural(ready.length, "clip")}`;
    rows.replaceChildren(...ready.map(({ id, name }) => h("label", {}, boxes.get(id) ?? "", name)));
  };
  offer();
  const element = h(
    "fieldset",
    { className: "take-clips" },
    h("legend", {}, "Clips"),
    h("label", {}, every, words),
    rows,
    olderClipsButton(offer),
  );
  const chosen = () => [...boxes.values()].filter((box) => box.checked).map(({ value }) => value);
  return { element, chosen };
}

/** Open the dialog that recognises all takes. */
export function openTakeTable() {
  const language = state.gestures;
  if (!language) return;
  const leaving = new AbortController();
  const { element, chosen } = clipChoice();
  const content = h("div", { className: "take-content" }, element);
  const start = h("button", { type: "submit", className: "primary" }, "Recognise all takes");
  const close = h("button", { type: "button", onclick: closeDialog }, "Close");
  const fail = (/** @type {string} */ text) =>
    content.replaceChildren(element, h("p", { className: "field-problem", role: "alert" }, text));
  const recognise = async () => {
    const clips = chosen();
    if (!clips.length) return fail("No clip is chosen; choose one whose takes are recognised.");
    const bar = h("progress", { "aria-label": "Progress of the table" });
    const words = h("p", { role: "status" }, "Recognising");
    const id = api.uniqueId();
    running = { id, bar, words };
    content.replaceChildren(words, bar);
    start.hidden = true;
    close.textContent = "Cancel";
    try {
      const table = await api.languages.takeTable(
        language.id,
        { id, clip_ids: clips },
        leaving.signal,
      );
      content.replaceChildren(...resultOf(table));
    } catch (error) {
      start.hidden = false;
      fail(`The takes could not be recognised: ${error.message}`);
    } finally {
      // Another table may have begun since this one was cancelled.
      if (running?.id === id) running = null;
      close.textContent = "Close";
    }
    return undefined;
  };
  const form = h(
    "form",
    { method: "dialog", className: "take-table", noValidate: true },
    h("h2", { id: "dialog-title" }, `All takes, recognised by ${language.name}`),
    content,
    h("div", { className: "dialog-actions" }, close, start),
  );
  form.onsubmit = (event) => {
    event.preventDefault();
    if (!start.hidden) recognise();
  };
  showDialog(form, () => leaving.abort());
  start.focus();
}

follow(["tabling"], () => advance(state.tabling));
