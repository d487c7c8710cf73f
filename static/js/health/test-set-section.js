// The section of the test with clips: dropping clips, correcting labels, confusion matrix, list.

import { olderClipsButton } from "../clips/older-clips.js";
import { h, WRITES } from "../core/dom.js";
import { plural } from "../core/format.js";
import { currentLanguage, follow, state, update } from "../core/state.js";
import { go } from "../core/views.js";
import { takeFilesIn } from "../upload/upload-list.js";
import { cancelTestRun, changeWords, runTestSet } from "../languages/test-set.js";
import { csvOf, testedOf } from "./test-set-results.js";
import {
  advance,
  ASKED,
  labels,
  placeOf,
  rankOf,
  readAs,
  REFUSED,
  takeRow,
  uploadRow,
  uploadsHere,
  waitingRow,
} from "./test-set-rows.js";
import {
  addLibraryClips,
  addTestClips,
  candidates,
  waitingClips,
  workOff,
} from "./test-set-clips.js";
import { confusionGrid } from "./confusion-grid.js";
import { pairName, pairOf } from "./finding-links.js";
import { rateText } from "./rates.js";

/** @import { TestSet, Upload } from "../core/types.d.ts" */

/** @import { TestedTake } from "./test-set-results.js" */

const SAVED_BY = 60000; // ms. A busy browser may read the file long after the click.

function drop() {
  const input = h("input", {
    type: "file",
    id: "test-clips",
    ...WRITES,
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
      { for: "test-clips", ...WRITES },
      h("b", {}, "Drop labelled clips"),
      h(
        "span",
        {},
        "or choose files. \u201ccircle-2.mp4\u201d is labelled circle; you can change the label.",
      ),
    ),
  );
}

/**
 * The counts, expected by recognised label; a cell opens its clip, or the list of its clips.
 *
 * @param {TestedTake[]} takes
 */
function matrix(takes) {
  const rows = [...new Set([...labels(), ...takes.map(({ expected }) => expected)])].filter(
    (label) => takes.some(({ expected }) => expected === label),
  );
  // A gesture that was neither meant nor read has nothing to tell.
  const columns = [...new Set([...rows, ...takes.map(readAs)])]
    .filter((label) => label !== REFUSED && label !== ASKED)
    .concat(takes.some(({ pair }) => pair) ? ASKED : [], REFUSED);
  /**
   * @param {number} row
   * @param {number} column
   */
  const cell = (row, column) => {
    const meant = takes.filter(({ expected }) => expected === rows[row]);
    const found = meant.filter((take) => readAs(take) === columns[column]);
    const right = rows[row] === columns[column];
    const asked = columns[column] === ASKED;
    const open =
      found.length === 1
        ? () => go("studio", placeOf(found[0], takes))
        : () => update({ cell: pairName(rows[row], columns[column]) });
    return {
      text: found.length ? `${found.length}${right ? " \u2713" : ""}` : "\u00b7",
      amount: found.length / meant.length,
      className: right ? "diagonal" : !found.length ? "" : asked ? "asked" : "wrong",
      open: found.length ? open : null,
      label: `${plural(found.length, "take")} of ${rows[row]} ${asked ? "" : "read as "}${columns[column]}`,
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

/** @param {TestedTake[]} takes */
function download(takes) {
  const url = URL.createObjectURL(new Blob([csvOf(takes)], { type: "text/csv" }));
  h("a", { href: url, download: `${currentLanguage().name} test.csv` }).click();
  setTimeout(() => URL.revokeObjectURL(url), SAVED_BY);
}

/**
 * A measured share in words; empty without takes.
 *
 * @param {TestSet["overall"]} share
 */
const shareText = ({ rate, low, high }) =>
  rate === null || low === null || high === null ? "" : `, ${rateText({ rate, low, high })}`;

/**
 * How many takes were asked back, and of how many the right gesture is in the pair.
 *
 * @param {Pick<TestSet["overall"], "pairs" | "pairs_right">} share
 */
const pairsText = ({ pairs, pairs_right: right }) =>
  pairs ? `; ${pairs} asked back, ${right} of them with the right gesture` : "";

/**
 * The rates of the gestures, the lowest first.
 *
 * @param {TestSet} testSet
 */
const rates = ({ gestures }) =>
  h(
    "ul",
    { className: "test-rates", "aria-label": "Rate of each gesture" },
    gestures.map((share) =>
      h(
        "li",
        {},
        h("b", {}, share.label),
        ` ${share.right} of ${share.asked}${shareText(share)}${pairsText(share)}`,
      ),
    ),
  );

/**
 * The note on takes that are not counted.
 *
 * @param {number} count
 */
const leftOutNote = (count) =>
  count
    ? h(
        "p",
        { className: "dim" },
        `${plural(count, "take")} of the list ${count > 1 ? "are demonstrations" : "is a demonstration"} of the language and ${count > 1 ? "do" : "does"} not count.`,
      )
    : null;

/**
 * The choice among the clips of the library that can be tested.
 *
 * @param {Map<string, boolean>} ticks Clips that the user has chosen or not; more are added.
 */
function libraryChoice(ticks) {
  const clips = candidates();
  if (!clips.length) return null;
  const boxes = clips.map(({ clip, expected }) => {
    const box = h("input", {
      type: "checkbox",
      value: clip.id,
      checked: ticks.get(clip.id) ?? Boolean(expected),
      onchange: () => ticks.set(clip.id, box.checked),
    });
    return { box, row: h("label", { className: "check" }, box, h("span", {}, clip.name)) };
  });
  const add = h(
    "button",
    {
      type: "button",
      className: "primary",
      ...WRITES,
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
      olderClipsButton(),
    ),
    add,
  );
}

/**
 * The progress of a run with a button that cancels it; if takes wait, the button that starts one.
 *
 * @param {TestSet} testSet
 */
function runControl({ waiting }) {
  const { testing } = state;
  if (!testing)
    return waiting
      ? h(
          "button",
          { type: "button", className: "primary", ...WRITES, onclick: () => runTestSet() },
          `Recognise ${plural(waiting, "take")} again`,
        )
      : null;
  return h(
    "span",
    { className: "test-run", role: "status" },
    `${testing.done} of ${plural(testing.total, "take")} recognised`,
    h("progress", {
      "aria-label": "Progress of the test",
      max: Math.max(1, testing.total),
      value: testing.done,
    }),
    h("button", { type: "button", ...WRITES, onclick: cancelTestRun }, "Cancel"),
  );
}

/**
 * @param {TestSet} testSet
 * @param {TestedTake[]} takes
 */
function summary(testSet, takes) {
  const { overall, waiting, upgraded } = testSet;
  const change = changeWords(testSet);
  return h(
    "div",
    { className: "test-summary" },
    h(
      "p",
      {},
      overall.asked
        ? [
            h("b", { className: "num" }, `${overall.right} of ${overall.asked}`),
            ` recognised as labelled${shareText(overall)}${pairsText(overall)}`,
          ]
        : "Nothing is recognised yet",
      change ? `; since the revision before: ${change}` : null,
      upgraded ? ". The program was upgraded in between, which may change answers too" : null,
      waiting
        ? h("span", { className: "dim" }, `, ${plural(waiting, "take")} not by the newest revision`)
        : null,
    ),
    h("span", { className: "spacer" }),
    runControl(testSet),
    h("button", { type: "button", onclick: () => download(takes) }, "Export as CSV"),
  );
}

/**
 * The takes of the chosen cell, or all; the wrong ones first.
 *
 * @param {TestedTake[]} takes
 * @param {Upload[]} uploads
 */
function list(takes, uploads) {
  const cell = pairOf(state.cell);
  const shown = cell
    ? takes.filter((take) => take.expected === cell[0] && readAs(take) === cell[1])
    : [...takes].sort((one, other) => rankOf(one) - rankOf(other));
  return [
    cell
      ? h(
          "p",
          { className: "test-filter", role: "status" },
          `Only takes of ${cell[0]} ${cell[1] === ASKED ? "" : "read as "}${cell[1]}`,
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
  /** @type {Map<string, boolean>} */
  const ticks = new Map();
  /** Offer the clips of the library; what is chosen among them stays when others come and go. */
  const drawChoice = () => {
    const now = candidates()
      .map(({ clip }) => clip.id)
      .join();
    if (now === offered) return;
    offered = now;
    const open = choice.querySelector("details")?.open ?? false;
    const drawnAnew = libraryChoice(ticks);
    if (drawnAnew) drawnAnew.open = open;
    choice.replaceChildren(drawnAnew ?? "");
  };
  const draw = () => {
    /** @type {HTMLElement | null} */ (content.querySelector("select:focus"))?.blur();
    const testSet = state.testSet?.language_id === state.language ? state.testSet : null;
    // The event about a take may arrive before the answer to the request that added its clip.
    const waiting = new Set(waitingClips().map(({ clip }) => clip.id));
    const takes = testedOf(testSet).filter(({ clip_id: clip }) => !waiting.has(clip));
    const demonstrations = takes.filter(({ demonstration }) => demonstration).length;
    const counted = takes.filter(({ demonstration, known }) => known && !demonstration);
    drawChoice();
    const uploads = uploadsHere();
    const empty = !takes.length && !waiting.size && !uploads.length;
    content.replaceChildren(
      ...(empty || !state.gestures
        ? []
        : [
            ...(testSet && takes.length ? [summary(testSet, takes)] : []),
            ...(testSet && counted.length ? [matrix(counted), rates(testSet)] : []),
            leftOutNote(demonstrations),
            ...list(takes, uploads),
          ].filter((each) => each !== null)),
    );
    drawn = stages();
    advance(content);
  };
  takeFilesIn("health", addTestClips);
  follow(["pending", "clips", "gestures"], workOff);
  follow(["testSet", "testing", "pending", "clips", "gestures", "cell"], draw);
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
        "Clips whose gesture you know, by other divers if you can: recognised again after every change of the language. A cell opens its clips.",
      ),
    ),
    drop(),
    choice,
    content,
  );
}
