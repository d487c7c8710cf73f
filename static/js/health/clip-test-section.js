// The section of the test with clips: dropping clips, correcting labels, confusion matrix, list.

import { statusText } from "../clips/clip-store.js";
import { h, iconButton } from "../core/dom.js";
import { plural } from "../core/format.js";
import { currentLanguage, follow, state, update } from "../core/state.js";
import { address, go, here } from "../core/views.js";
import { takeFilesIn } from "../upload/upload-list.js";
import { csvOf, intervalOf, ratesOf, testedOf } from "./clip-test-results.js";
import {
  addLibraryClips,
  addTestClips,
  candidates,
  correct,
  leaveOut,
  leaveWaiting,
  loadTested,
  means,
  repeat,
  waitingClips,
  workOff,
} from "./clip-test.js";
import { confusionGrid } from "./confusion-grid.js";
import { pairName, pairOf } from "./finding-links.js";
import { rateText } from "./rates.js";

const REFUSED = "refused";
const SAVED_BY = 60000; // ms. A busy browser reads the file some time after the click.

const labels = () => state.gestures?.labels ?? [];
const readAs = ({ label }) => label ?? REFUSED;

function drop() {
  const input = h("input", {
    type: "file",
    id: "test-clips",
    multiple: true,
    accept: "video/*,.mkv",
    className: "visually-hidden",
  });
  input.onchange = () => {
    addTestClips([...(input.files ?? [])]);
    input.value = "";
  };
  return h(
    "div",
    { className: "drop" },
    input,
    h(
      "label",
      { for: "test-clips" },
      h("b", {}, "Drop labelled clips"),
      h(
        "span",
        {},
        "or choose files. \u201ccircle-2.mp4\u201d is labelled circle; you can change the label.",
      ),
    ),
  );
}

function labelSelect(name, value, onchange) {
  const known = value && !labels().includes(value) ? [value] : [];
  const select = h(
    "select",
    { "aria-label": `What ${name} shows`, onchange: () => onchange(select.value) },
    value ? null : h("option", { value: "" }, "choose\u2026"),
    [...labels(), ...known].map((label) =>
      h("option", { value: label, selected: label === value }, label),
    ),
  );
  return select;
}

const uploadsHere = () => state.uploads.filter(({ uploaded }) => uploaded);

/** What is not in the test yet, as `{ key, text, total, done }`: how far each is. */
function advances() {
  const uploads = uploadsHere().map(({ key, status, error, total, loaded }) => ({
    key: `upload ${key}`,
    text:
      status === "failed"
        ? error
        : status === "waiting"
          ? "Waiting for the other uploads"
          : "Uploading",
    total: Math.max(1, total),
    done: loaded,
  }));
  const clips = waitingClips().map(({ clip, expected }) => {
    const job = state.jobs.get(clip.job_id);
    return {
      key: clip.id,
      text:
        clip.status === "done"
          ? expected
            ? "Recognising"
            : "Choose its label"
          : statusText(clip, job),
      total: job?.total,
      done: job?.done,
    };
  });
  return [...uploads, ...clips];
}

/**
 * Move texts and bars on in the rows that are there: what is just being pressed stays where it is.
 */
function advance(content) {
  const rows = new Map(
    [...content.querySelectorAll("tr.waiting")].map((row) => [row.dataset.key, row]),
  );
  for (const { key, text, total, done } of advances()) {
    const row = rows.get(key);
    if (!row) continue;
    row.querySelector(".stage-text").textContent = text;
    const bar = row.querySelector("progress");
    if (bar && total) Object.assign(bar, { max: total, value: done });
  }
}

function waitingRow({ clip, expected, busy }) {
  return h(
    "tr",
    { className: "waiting", "data-key": clip.id },
    h("td", {}, clip.name),
    h(
      "td",
      {},
      labelSelect(clip.name, expected, (label) => means(clip.id, label)),
    ),
    h(
      "td",
      { colSpan: 2 },
      h("span", { className: "stage-text" }),
      busy ? h("progress", { "aria-label": `Poses of ${clip.name}` }) : null,
    ),
    h(
      "td",
      {},
      iconButton("close", `Leave ${clip.name} out of the test`, () => leaveWaiting(clip)),
    ),
  );
}

function uploadRow({ key, file, status, cancel }) {
  return h(
    "tr",
    { className: "waiting", "data-key": `upload ${key}` },
    h("td", {}, file.name),
    h("td", {}),
    h(
      "td",
      { colSpan: 2 },
      h("span", { className: "stage-text" }),
      status === "failed" ? null : h("progress", { "aria-label": `Upload of ${file.name}` }),
    ),
    h("td", {}, status === "uploading" ? iconButton("close", `Cancel ${file.name}`, cancel) : null),
  );
}

/** Where a take and its recognition are shown. */
function placeOf(take, takes) {
  const alone = takes.filter((each) => each.clip_id === take.clip_id).length === 1;
  return {
    clip: take.clip_id,
    recognition: take.id,
    take: null,
    start: alone ? null : take.start,
    end: alone ? null : take.end,
    frame: null,
    pair: null,
  };
}

function takeRow(take, takes) {
  const several = takes.filter((each) => each.clip_id === take.clip_id);
  const name = several.length > 1 ? `${take.clip}, take ${several.indexOf(take) + 1}` : take.clip;
  const place = placeOf(take, takes);
  return h(
    "tr",
    { className: take.demonstration ? "demonstration" : take.right ? "" : "wrong" },
    h(
      "td",
      {},
      h(
        "a",
        {
          href: address("studio", place),
          title: "Show the clip and why",
          onclick: here(() => go("studio", place)),
        },
        name,
      ),
    ),
    h(
      "td",
      {},
      labelSelect(name, take.expected, (label) => correct(take, label)),
    ),
    h(
      "td",
      {},
      h(
        "span",
        { className: "outcome-sign", "aria-hidden": "true" },
        take.right ? "\u2713" : "\u2260",
      ),
      h("span", {}, take.right ? "right: " : "wrong: "),
      h("b", {}, readAs(take)),
      take.demonstration ? h("small", { className: "dim" }, ", a demonstration") : null,
      take.label === null ? h("small", { className: "dim" }, `, nearest ${take.nearest}`) : null,
    ),
    h("td", { className: "num" }, `${Math.round(100 * take.confidence)} %`),
    h(
      "td",
      {},
      iconButton("close", `Leave ${name} out of the test`, () => leaveOut(take, name)),
    ),
  );
}

/** The counts, meant by read; a cell opens its clip, or the list of its clips. */
function matrix(takes) {
  const rows = [...new Set([...labels(), ...takes.map(({ expected }) => expected)])].filter(
    (label) => takes.some(({ expected }) => expected === label),
  );
  const columns = [...new Set([...labels(), ...takes.map(readAs)])]
    .filter((label) => label !== REFUSED)
    .concat(REFUSED);
  const cell = (row, column) => {
    const meant = takes.filter(({ expected }) => expected === rows[row]);
    const found = meant.filter((take) => readAs(take) === columns[column]);
    const right = rows[row] === columns[column];
    const open =
      found.length === 1
        ? () => go("studio", placeOf(found[0], takes))
        : () => update({ cell: pairName(rows[row], columns[column]) });
    return {
      text: found.length ? `${found.length}${right ? " \u2713" : ""}` : "\u00b7",
      amount: found.length / meant.length,
      className: right ? "diagonal" : found.length ? "wrong" : "",
      open: found.length ? open : null,
      label: `${plural(found.length, "take")} of ${rows[row]} read as ${columns[column]}`,
    };
  };
  return confusionGrid({
    label: "Confusions of the test clips",
    corner: "meant \u2193  read as \u2192",
    rows: rows.map((label) => ({ label })),
    columns: columns.map((label) => ({ label })),
    cell,
  });
}

function download(takes) {
  const url = URL.createObjectURL(new Blob([csvOf(takes)], { type: "text/csv" }));
  h("a", { href: url, download: `${currentLanguage().name} test.csv` }).click();
  setTimeout(() => URL.revokeObjectURL(url), SAVED_BY);
}

/** The rates of the gestures, the lowest first. */
const rates = (takes) =>
  h(
    "ul",
    { className: "test-rates", "aria-label": "Rate of each gesture" },
    ratesOf(takes).map(({ label, right, count, ...rate }) =>
      h("li", {}, h("b", {}, label), ` ${right} of ${count}, ${rateText(rate)}`),
    ),
  );

/** What is said of takes that count nothing. */
const leftOutNote = (count) =>
  count
    ? h(
        "p",
        { className: "dim" },
        `${plural(count, "take")} of the list ${count > 1 ? "are demonstrations" : "is a demonstration"} of the language and ${count > 1 ? "do" : "does"} not count.`,
      )
    : null;

/** The clips of the library that can be tested, to be chosen. */
function libraryChoice() {
  const clips = candidates();
  if (!clips.length) return null;
  const boxes = clips.map(({ clip, expected }) => {
    const box = h("input", { type: "checkbox", value: clip.id, checked: Boolean(expected) });
    return { box, row: h("label", { className: "check" }, box, h("span", {}, clip.name)) };
  });
  const add = h(
    "button",
    {
      type: "button",
      className: "primary",
      onclick: () =>
        addLibraryClips(boxes.filter(({ box }) => box.checked).map(({ box }) => box.value)),
    },
    "Test the chosen clips",
  );
  return h(
    "details",
    { className: "library-choice" },
    h("summary", {}, `Choose from the ${plural(clips.length, "clip")} of this studio`),
    h(
      "div",
      { className: "library-boxes" },
      boxes.map(({ row }) => row),
    ),
    add,
  );
}

function summary(takes) {
  const right = takes.filter((take) => take.right).length;
  const old = takes.filter(({ revision }) => revision !== currentLanguage().revision).length;
  const again = h("button", { type: "button" }, old ? "Recognise again" : "Repeat the test");
  again.onclick = async () => {
    again.disabled = true;
    await repeat(takes, (done) => {
      again.textContent = `${done} of ${takes.length}`;
    });
  };
  return h(
    "div",
    { className: "test-summary" },
    h(
      "p",
      {},
      h("b", { className: "num" }, `${right} of ${takes.length}`),
      ` recognised as labelled, ${rateText(intervalOf(right, takes.length))}`,
      old ? h("span", { className: "dim" }, `, ${old} by an older revision of the language`) : null,
    ),
    h("span", { className: "spacer" }),
    again,
    h("button", { type: "button", onclick: () => download(takes) }, "Export as CSV"),
  );
}

/** The takes of the chosen cell, or all; the wrong ones first. */
function list(takes, uploads) {
  const cell = pairOf(state.cell);
  const shown = cell
    ? takes.filter((take) => take.expected === cell[0] && readAs(take) === cell[1])
    : [...takes].sort((one, other) => one.right - other.right);
  return [
    cell
      ? h(
          "p",
          { className: "test-filter", role: "status" },
          `Only takes of ${cell[0]} read as ${cell[1]}`,
          h(
            "button",
            { type: "button", className: "link", onclick: () => update({ cell: null }) },
            "Show all",
          ),
        )
      : null,
    h(
      "div",
      { className: "confusion-scroll" },
      h(
        "table",
        { className: "takes" },
        h("caption", { className: "visually-hidden" }, "The test clips"),
        h(
          "thead",
          {},
          h(
            "tr",
            {},
            ["Clip", "Shows", "Read as", "Confidence"].map((text) =>
              h("th", { scope: "col" }, text),
            ),
            h("td", {}),
          ),
        ),
        h(
          "tbody",
          {},
          cell ? [] : uploads.map(uploadRow),
          cell ? [] : waitingClips().map(waitingRow),
          shown.map((take) => takeRow(take, takes)),
        ),
      ),
    ),
  ];
}

/** Make the section, and keep it in step. */
export function batchSection() {
  const content = h("div", { className: "test-content" });
  const choice = h("div");
  const stages = () =>
    uploadsHere()
      .map(({ key, status }) => `${key} ${status}`)
      .join();
  let drawn = "";
  let offered = "";
  /** Offer the clips of the library; what is chosen among them stays while they are the same. */
  const drawChoice = () => {
    const now = candidates()
      .map(({ clip }) => clip.id)
      .join();
    if (now === offered) return;
    offered = now;
    choice.replaceChildren(libraryChoice() ?? "");
  };
  const draw = () => {
    /** @type {HTMLElement | null} */ (content.querySelector("select:focus"))?.blur();
    const { tested, clips, gestures } = state;
    const takes = testedOf(tested, clips, gestures?.profile, gestures?.gestures);
    const counted = takes.filter(({ demonstration }) => !demonstration);
    drawChoice();
    const uploads = uploadsHere();
    const empty = !takes.length && !waitingClips().length && !uploads.length;
    content.replaceChildren(
      ...(empty || !state.gestures
        ? []
        : [
            ...(counted.length ? [summary(counted), matrix(counted), rates(counted)] : []),
            leftOutNote(takes.length - counted.length),
            ...list(takes, uploads),
          ].filter((each) => each !== null)),
    );
    drawn = stages();
    advance(content);
  };
  takeFilesIn("health", addTestClips);
  follow(["language", "recognised"], loadTested);
  follow(["pending", "clips", "gestures"], workOff);
  follow(["tested", "pending", "clips", "gestures", "cell"], draw);
  // Progress comes many times a second.
  follow(["jobs", "uploads"], () => {
    if (stages() === drawn) advance(content);
    else draw();
  });
  return h(
    "section",
    { className: "health-section", "aria-labelledby": "test-title" },
    h(
      "div",
      { className: "section-head" },
      h("h2", { id: "test-title", tabIndex: -1 }, "Test with clips"),
      h(
        "p",
        { className: "dim" },
        "Clips whose gesture you know, by other divers if you can: what is estimated above is measured here. A cell opens its clips.",
      ),
    ),
    drop(),
    choice,
    content,
  );
}
