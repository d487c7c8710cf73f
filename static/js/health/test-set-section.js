// The section of the test with clips: dropping clips, correcting labels, confusion matrix, list.

import { olderClipsButton } from "../clips/older-clips.js";
import { saveFile } from "../clips/mcap-export.js";
import { ASKED, headsOf, rankOf, readAs, REFUSED, takesTable } from "../clips/takes.js";
import { plural } from "../core/format.js";
import { currentLanguage, state, update } from "../core/state.js";
import { buttonOf, guard, html, live, nothing, progressBar, repeat } from "../templates.js";
import { go } from "../core/views.js";
import { cancelTestRun, changeWords, NONE, runTestSet } from "../languages/test-set.js";
import { csvOf, testedOf } from "./test-set-results.js";
import { labels, placeOf, testedRow, uploadRow, uploadsHere, waitingRow } from "./test-set-rows.js";
import { addLibraryClips, addTestClips, candidates, waitingClips } from "./test-set-clips.js";
import { confusionGrid } from "./confusion-grid.js";
import { pairName, pairOf } from "./finding-links.js";
import { testedText } from "./rates.js";

/** @import { TestSet } from "../core/types.d.ts" */

/** @import { TestedTake } from "./test-set-results.js" */

/** @type {Map<string, boolean>} */
const ticks = new Map(); // Clips of the library that the user has chosen or not.

/**
 * Draw what follows from the takes only if they change: progress comes many times a second.
 *
 * @param {() => unknown} draw
 */
function onChange(draw) {
  const { testSet, gestures, pending, clips, cell } = state;
  return guard([testSet, gestures, pending, clips, cell], draw);
}

/** @param {Event & { target: HTMLInputElement }} event */
function takeFiles({ target }) {
  addTestClips([...(target.files ?? [])]);
  target.value = "";
}

/**
 * The counts, expected by recognised label; a cell opens its clip, or the list of its clips.
 *
 * @param {TestedTake[]} takes
 */
function matrix(takes) {
  const meant = [...new Set([...labels(), ...takes.map(({ expected }) => expected)])];
  const rows = [...meant.filter((label) => label !== NONE), NONE].filter((label) =>
    takes.some(({ expected }) => expected === label),
  );
  // A gesture that was neither meant nor read has nothing to tell.
  const columns = [...new Set([...rows, ...takes.map(readAs)])]
    .filter((label) => ![REFUSED, ASKED, NONE].includes(label))
    .concat(takes.some(({ pair }) => pair) ? ASKED : [], REFUSED);
  /**
   * @param {number} row
   * @param {number} column
   */
  const cell = (row, column) => {
    const shown = takes.filter(({ expected }) => expected === rows[row]);
    const found = shown.filter((take) => readAs(take) === columns[column]);
    const right = columns[column] === (rows[row] === NONE ? REFUSED : rows[row]);
    const asked = columns[column] === ASKED;
    const open =
      found.length === 1
        ? () => go("studio", placeOf(found[0], takes))
        : () => update({ cell: pairName(rows[row], columns[column]) });
    return {
      text: found.length ? `${found.length}${right ? " \u2713" : ""}` : "\u00b7",
      amount: found.length / shown.length,
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
const download = (takes) =>
  saveFile({
    name: `${currentLanguage().name} test.csv`,
    content: new Blob([csvOf(takes)], { type: "text/csv" }),
  });

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
const rates = ({ gestures, none }) =>
  html`<ul class="test-rates" aria-label="Rate of each gesture">
    ${gestures.map(
      (share) =>
        html`<li>
          <b>${share.label}</b> ${share.right} of
          ${share.asked}${testedText(share)}${pairsText(share)}
        </li>`,
    )}
    ${
      none.refused + none.asked_back + none.answered
        ? html`<li>
            <b>${NONE}</b> ${none.refused} refused: right; ${none.asked_back} asked back;
            ${none.answered} read as a gesture: wrong
          </li>`
        : nothing
    }
  </ul>`;

const olderClips = olderClipsButton();

/**
 * The choice among the clips of the library that can be tested. Without the language and its tests,
 * boxes would move and be ticked later, under the pointer.
 *
 * @param {TestSet | null} testSet
 */
function libraryChoice(testSet) {
  const clips = testSet ? candidates(testSet) : [];
  if (!clips.length) return nothing;
  /** @param {typeof clips[number]} candidate */
  const chosen = ({ clip, expected }) => ticks.get(clip.id) ?? Boolean(expected);
  const add = () => addLibraryClips(clips.filter(chosen).map(({ clip }) => clip.id));
  return html`<details class="library-choice">
    <summary>Choose from the ${plural(clips.length, "clip")} of this studio</summary>
    <div class="library-boxes">
      ${repeat(
        clips,
        ({ clip }) => clip.id,
        (each) =>
          html`<label class="check"
            ><input
              type="checkbox"
              value=${each.clip.id}
              .checked=${live(chosen(each))}
              @change=${(/** @type {any} */ { target }) => ticks.set(each.clip.id, target.checked)}
            /><span>${each.clip.name}</span></label
          >`,
      )}${olderClips}
    </div>
    <button type="button" class="primary" data-writes @click=${add}>Test the chosen clips</button>
  </details>`;
}

/**
 * The progress of a run with a button that cancels it; if takes wait, the button that starts one.
 *
 * @param {TestSet} testSet
 */
function runControl({ waiting }) {
  const { testing } = state;
  if (testing)
    return html`<span class="test-run" role="status"
      >${testing.done} of ${plural(testing.total, "take")}
      recognised${progressBar("Progress of the test", testing.done, testing.total)}<button
        type="button"
        data-writes
        @click=${cancelTestRun}
      >
        Cancel
      </button></span
    >`;
  return waiting
    ? html`<button type="button" class="primary" data-writes @click=${() => runTestSet()}>
        Recognise ${plural(waiting, "take")} again
      </button>`
    : nothing;
}

/**
 * @param {TestSet} testSet
 * @param {TestedTake[]} takes
 */
function summary(testSet, takes) {
  const { overall, waiting, upgraded } = testSet;
  const change = changeWords(testSet);
  const counted = html`<b class="num">${overall.right} of ${overall.asked + overall.untestable}</b>
    recognised as labelled${testedText(overall)}${pairsText(overall)}`;
  const older = html`<span class="dim"
    >, ${plural(waiting, "take")} not by the newest revision</span
  >`;
  return html`<div class="test-summary">
    <p>
      ${overall.asked ? counted : "Nothing is recognised yet"}${change && `; ${change}`}${
        upgraded ? ". The program was upgraded in between, which may change answers too" : ""
      }${waiting ? older : ""}
    </p>
    <span class="spacer"></span>${runControl(testSet)}
    <button type="button" @click=${() => download(takes)}>Export as CSV</button>
  </div>`;
}

/**
 * The takes of the chosen cell, or all; the wrong ones first.
 *
 * @param {TestedTake[]} takes
 */
function list(takes) {
  const cell = pairOf(state.cell);
  const shown = cell
    ? takes.filter((take) => take.expected === cell[0] && readAs(take) === cell[1])
    : [...takes].sort((one, other) => rankOf(one) - rankOf(other));
  const filter =
    cell &&
    html`<p class="test-filter" role="status">
      Only takes of ${cell[0]}
      ${cell[1] === ASKED ? "" : "read as "}${cell[1]}${buttonOf(
        "Show all",
        () => update({ cell: null }),
        { look: "link" },
      )}
    </p>`;
  return html`${filter}
  ${takesTable("The test clips", headsOf(["Clip", "Shows", "Read as", "Confidence", ""]), [
    cell ? "" : repeat(uploadsHere(), ({ key }) => key, uploadRow),
    cell ? "" : repeat(waitingClips(), ({ clip }) => clip.id, waitingRow),
    onChange(() =>
      repeat(
        shown,
        ({ id }) => id,
        (take) => testedRow(take, takes),
      ),
    ),
  ])}`;
}

/** @param {TestSet | null} testSet */
function content(testSet) {
  // The event about a take may arrive before the answer to the request that added its clip.
  const waiting = new Set(waitingClips().map(({ clip }) => clip.id));
  const takes = testedOf(testSet).filter(({ clip_id: clip }) => !waiting.has(clip));
  const counted = takes.filter(({ known }) => known);
  if (!state.gestures || !(takes.length || waiting.size || uploadsHere().length)) return nothing;
  const counts = onChange(() => matrix(counted));
  return html`${testSet && takes.length ? summary(testSet, takes) : ""}
  ${testSet && counted.length ? [counts, rates(testSet)] : ""} ${list(takes)}`;
}

/**
 * The section, as the state has it.
 *
 * @param {TestSet | null} testSet of the language on display
 */
export const batchSection = (testSet) =>
  html`<section class="health-section" aria-labelledby="test-title">
    <div class="section-head">
      <h2 id="test-title" tabindex="-1">Test with clips</h2>
      <p class="dim">
        Clips whose gesture you know, by other divers if you can: recognised again after every
        change of the language. A cell opens its clips.
      </p>
    </div>
    <div class="drop">
      <input
        type="file"
        id="test-clips"
        class="visually-hidden"
        data-writes
        multiple
        accept="video/*,.mkv"
        @change=${takeFiles}
      /><label for="test-clips" data-writes
        ><b>Drop labelled clips</b
        ><span
          >or choose files. “circle-2.mp4” is labelled circle; you can change the label.</span
        ></label
      >
    </div>
    <div>${libraryChoice(testSet)}</div>
    <div class="test-content">${content(testSet)}</div>
  </section>`;
