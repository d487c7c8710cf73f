// The decision beside the picture: the compared images, and every voter's distance to every
// gesture, with weight factors to try.

import * as api from "../core/api.js";
import { byId } from "../core/dom.js";
import { percent, plural, readable } from "../core/format.js";
import { isReadable, state } from "../core/state.js";
import { attempt } from "../core/toasts.js";
import { FACTORS } from "../languages/settings-dialog.js";
import { html, nothing, optionsOf, render, until } from "../templates.js";
import { tryOut } from "./intervention-trial.js";
import { supportOf } from "./vote-support.js";
import {
  byDistance,
  MOST_COLUMNS,
  nearnessOf,
  orderOf,
  shortNumber,
  splitByWeight,
} from "./vote-order.js";

/** @import { Recognition, State } from "../core/types.d.ts" */

/**
 * The explanation of the two numbers of a decision, per profile.
 *
 * @type {Record<Recognition["profile"], string>}
 */
const CONFIDENCE_WORDS = {
  full: "Confidence is the estimated probability that this gesture was meant; the distance is that of all comparisons together, about 1 for another gesture.",
  paper:
    "Confidence says how clearly the winner leads, by votes and by distance; the weight is that of the comparisons whose nearest gesture it is.",
};

/** @type {(factor: number) => string} */
const factorText = (factor) =>
  factor === 0 ? "off" : `${{ 0.25: "\u00bc", 0.5: "\u00bd" }[factor] ?? factor} \u00d7`;

/**
 * @param {string} voter
 * @param {number} factor
 */
const wordsOf = (voter, factor) =>
  factor === 0
    ? `without the comparison ${readable(voter)}`
    : `with ${factor} times the weight on the comparison ${readable(voter)}`;

/**
 * The weight factors in the recognition on display; 1 by default.
 *
 * @param {Recognition} result
 * @returns {Record<string, number>}
 */
const factorsOf = (result) => (result.tuning ?? state.gestures?.tuning)?.weights ?? {};

/**
 * The cell of a voter's weight, with the choice of another weight factor over it.
 *
 * @param {Recognition} result
 * @param {string} voter
 */
function weightCell(result, voter) {
  const factor = factorsOf(result)[voter] ?? 1;
  const weight = result.weights[voter] ?? 0;
  const factors = FACTORS.includes(factor) ? FACTORS : [...FACTORS, factor].sort((a, b) => a - b);
  /** @type {[string, string][]} */
  const options = factors.map((each) => [String(each), factorText(each)]);
  const weigh = (/** @type {any} */ { target }) => {
    const chosen = Number(target.value);
    const words = wordsOf(voter, chosen);
    tryOut({ change: { kind: "weight_factor", voter, factor: chosen, words } });
  };
  return html`<td class="weight">
    ${percent(weight)}${factor === 1 ? nothing : html`<b> ${factorText(factor)}</b>`}<select
      aria-label="Weight of ${readable(voter)}: ${percent(weight)}"
      title="Try another weight factor; only Keep saves it"
      @change=${weigh}
    >
      ${optionsOf(options, String(factor))}
    </select>
  </td>`;
}

/**
 * @param {Recognition} result
 * @param {number} at
 * @param {number[]} columns
 */
function row(result, at, columns) {
  const voter = result.voters[at];
  const nearness = nearnessOf(result.distances[at]);
  const cells = columns.map((column) => {
    const share = (4 + 42 * nearness[column] ** 2).toFixed(0);
    const choice = result.votes[voter] === result.gestures[column];
    return html`<td
      class=${choice ? "choice" : ""}
      .style=${`background: color-mix(in srgb, var(--accent) ${share}%, transparent)`}
    >
      ${shortNumber(result.distances[at][column])}
    </td>`;
  });
  return html`<tr class=${result.weights[voter] ? "" : "mute"}>
    <th scope="row">${readable(voter)}</th>
    ${weightCell(result, voter)}${cells}
  </tr>`;
}

/**
 * @param {Recognition} result
 * @param {number} column
 */
function head({ gestures, label, expected }, column) {
  const name = gestures[column];
  const kind = name === label ? "chosen" : name === expected ? "expected" : "";
  const roles = [name === label ? "chosen" : "", name === expected ? "expected" : ""]
    .filter(Boolean)
    .join(", ");
  return html`<th scope="col" class="gesture ${kind}" title=${roles ? `${name}: ${roles}` : name}>
    <span>${name}</span>${roles && html`<span class="visually-hidden">${roles}</span>`}
  </th>`;
}

/**
 * @param {Recognition} result
 * @param {number[]} rows
 * @param {number[]} columns
 */
function table(result, rows, columns) {
  const support = supportOf(result);
  return html`<div class="vote-scroll" tabindex="0" role="group" aria-label="Votes, scrollable">
    <table class="vote-table" aria-label="Votes">
      <thead>
        <tr>
          <th scope="col">by</th>
          <th scope="col">weight</th>
          ${columns.map((column) => head(result, column))}
        </tr>
      </thead>
      <tbody>
        ${rows.map((at) => row(result, at, columns))}
      </tbody>
      <tfoot>
        ${
          byDistance(result)
            ? html`<tr>
                <th scope="row" colspan="2">distance</th>
                ${columns.map((column) => html`<td>${shortNumber(result.scores[column])}</td>`)}
              </tr>`
            : nothing
        }
        <tr>
          <th scope="row" colspan="2">weight for it</th>
          ${columns.map(
            (column) =>
              html`<td class="votes-for">
                ${percent(support.get(result.gestures[column]) ?? 0)}
              </td>`,
          )}
        </tr>
      </tfoot>
    </table>
  </div>`;
}

let whole = false; // Whether voters without weight are shown, too.

/**
 * The table of the voters with weight, and a line that shows those without.
 *
 * @param {Recognition} result
 */
function ballot(result) {
  const { rows, columns } = orderOf(result);
  const { heard, silent } = splitByWeight(result, rows, factorsOf(result));
  const turn = () => {
    whole = !whole;
    render(decision(result), byId("votes"));
  };
  const text = whole ? "Hide" : "Show";
  const toggle = html`<button
    type="button"
    class="link"
    aria-expanded=${whole}
    aria-label="${text} the comparisons without weight"
    @click=${turn}
  >
    ${text}
  </button>`;
  const words = `${plural(silent.length, "comparison")} without weight`;
  return html`<div>${table(result, whole ? rows : heard, columns)}</div>
    ${silent.length ? html`<p class="dim">${words} ${toggle}</p>` : nothing}`;
}

/** @type {{ of: string, figures: Promise<unknown> }} */
let images = { of: "", figures: Promise.resolve(nothing) };

/**
 * The compared images, loaded once.
 *
 * @param {string} id of the recognition
 */
function imagesOf(id) {
  const load = async () => {
    const found = await attempt("Loading the images", () => api.recognitions.images(id));
    return (found ?? []).map(
      ({ caption, image }) =>
        html`<figure>
          <img alt="Trajectory image: ${caption}" width="64" height="64" src=${image} />
          <figcaption>${caption}</figcaption>
        </figure>`,
    );
  };
  if (images.of !== id) images = { of: id, figures: load() };
  return until(images.figures, nothing);
}

/** @param {Recognition | null} result */
function decision(result) {
  if (!result)
    return html`<div class="undecided">
      <h2>No decision yet</h2>
      <p class="dim">
        Recognise the take to see how near each gesture is, or save it as a gesture.
      </p>
    </div>`;
  return html`<div class="vote-images">${imagesOf(result.id)}</div>
    ${ballot(result)}
    <p class="dim">${CONFIDENCE_WORDS[result.profile]}</p>`;
}

/**
 * Draw the decision of the recognition on display.
 *
 * @param {State} state
 */
export function drawVotes({ result }) {
  const box = byId("votes");
  box.hidden = !isReadable();
  if (box.hidden) return;
  // The same width before and after the decision, so that the picture stays in place.
  const columns = (result?.gestures ?? state.gestures?.labels ?? []).length;
  box.style.setProperty("--columns", String(Math.min(columns, MOST_COLUMNS)));
  render(decision(result), box);
}
