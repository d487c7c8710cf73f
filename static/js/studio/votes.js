// The decision beside the picture: the compared images, and every voter's distance to every
// gesture, with weight factors to try.

import * as api from "../core/api.js";
import { byId, h } from "../core/dom.js";
import { percent, plural, readable } from "../core/format.js";
import { isReadable, state } from "../core/state.js";
import { attempt } from "../core/toasts.js";
import { tryOut } from "./intervention-trial.js";
import { supportOf } from "./vote-support.js";
import { MOST_COLUMNS, nearnessOf, orderOf, shortNumber, splitByWeight } from "./vote-order.js";

/** @import { Recognition, State } from "../core/types.d.ts" */

/**
 * The explanation of the two numbers of a decision, per profile.
 *
 * @type {Record<Recognition["profile"], string>}
 */
const CONFIDENCE_WORDS = {
  full: "Confidence is the estimated probability that this gesture was meant; the weight is that of the voters whose nearest gesture it is.",
  paper:
    "Confidence says how clearly the winner leads, by votes and by distance; the weight is that of the voters whose nearest gesture it is.",
};

const FACTORS = [0, 0.25, 0.5, 1, 2, 4];

/** @type {(factor: number) => string} */
const factorText = (factor) =>
  factor === 0 ? "off" : `${{ 0.25: "\u00bc", 0.5: "\u00bd" }[factor] ?? factor} \u00d7`;

/**
 * @param {string} voter
 * @param {number} factor
 */
const wordsOf = (voter, factor) =>
  factor === 0
    ? `without the voter ${readable(voter)}`
    : `with ${factor} times the weight on the voter ${readable(voter)}`;

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
  const select = h(
    "select",
    {
      "aria-label": `Weight of ${readable(voter)}: ${percent(weight)}`,
      title: "Try another weight factor; only Keep saves it",
      onchange: () =>
        tryOut({
          change: {
            kind: "weight_factor",
            voter,
            factor: Number(select.value),
            words: wordsOf(voter, Number(select.value)),
          },
        }),
    },
    factors.map((each) => h("option", { value: each }, factorText(each))),
  );
  select.value = String(factor);
  return h(
    "td",
    { className: "weight" },
    percent(weight),
    factor === 1 ? null : h("b", {}, ` ${factorText(factor)}`),
    select,
  );
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
    return h(
      "td",
      {
        className: choice ? "choice" : "",
        style: { background: `color-mix(in srgb, var(--accent) ${share}%, transparent)` },
      },
      shortNumber(result.distances[at][column]),
    );
  });
  return h(
    "tr",
    { className: result.weights[voter] ? "" : "mute" },
    h("th", { scope: "row" }, readable(voter)),
    weightCell(result, voter),
    cells,
  );
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
  return h(
    "th",
    { scope: "col", className: `gesture ${kind}`, title: roles ? `${name}: ${roles}` : name },
    h("span", {}, name),
    roles ? h("span", { className: "visually-hidden" }, roles) : null,
  );
}

/**
 * @param {Recognition} result
 * @param {number[]} rows
 * @param {number[]} columns
 */
function table(result, rows, columns) {
  const support = supportOf(result);
  return h(
    "div",
    { className: "vote-scroll", tabIndex: 0, role: "group", "aria-label": "Votes, scrollable" },
    h(
      "table",
      { className: "vote-table", "aria-label": "Votes" },
      h(
        "thead",
        {},
        h(
          "tr",
          {},
          h("th", { scope: "col" }, "voter"),
          h("th", { scope: "col" }, "weight"),
          columns.map((column) => head(result, column)),
        ),
      ),
      h(
        "tbody",
        {},
        rows.map((at) => row(result, at, columns)),
      ),
      h(
        "tfoot",
        {},
        h(
          "tr",
          {},
          h("th", { scope: "row", colSpan: 2 }, "weight of its voters"),
          columns.map((column) =>
            h("td", { className: "votes-for" }, percent(support.get(result.gestures[column]) ?? 0)),
          ),
        ),
      ),
    ),
  );
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
  const place = h("div");
  const toggle = h("button", {
    type: "button",
    className: "link",
    onclick: () => {
      whole = !whole;
      draw();
    },
  });
  const draw = () => {
    place.replaceChildren(table(result, whole ? rows : heard, columns));
    toggle.textContent = whole ? "Hide" : "Show";
    toggle.setAttribute("aria-expanded", String(whole));
    toggle.setAttribute("aria-label", `${toggle.textContent} the voters without weight`);
  };
  draw();
  const line = h("p", { className: "dim" }, `${plural(silent.length, "voter")} without weight `);
  line.append(toggle);
  return silent.length ? [place, line] : [place];
}

/**
 * Load the compared images into a box.
 *
 * @param {HTMLElement} box
 * @param {Recognition} result
 */
async function loadImages(box, result) {
  const images = await attempt("Loading the images", () => api.recognitions.images(result.id));
  box.replaceChildren(
    ...(images ?? []).map(({ caption, image }) =>
      h(
        "figure",
        {},
        h("img", { src: image, alt: `Trajectory image: ${caption}`, width: 64, height: 64 }),
        h("figcaption", {}, caption),
      ),
    ),
  );
}

const undecided = () =>
  h(
    "div",
    { className: "undecided" },
    h("h2", {}, "No decision yet"),
    h(
      "p",
      { className: "dim" },
      "Recognise the take to see how near each gesture is, or save it as a gesture.",
    ),
  );

/** @type {string | null} */
let drawn = null;

/**
 * Draw the decision of the recognition on display.
 *
 * @param {State} state
 */
export function drawVotes({ result }) {
  const box = byId("votes");
  box.hidden = !isReadable();
  const key = result
    ? `${result.id} ${JSON.stringify(state.gestures?.tuning ?? null)}`
    : `undecided ${state.gestures?.labels.length}`;
  if (box.hidden || key === drawn) return;
  drawn = key;
  // The same width before and after the decision, so that the picture stays in place.
  const columns = (result?.gestures ?? state.gestures?.labels ?? []).length;
  box.style.setProperty("--columns", String(Math.min(columns, MOST_COLUMNS)));
  if (!result) return box.replaceChildren(undecided());
  const images = h("div", { className: "vote-images" });
  const words = CONFIDENCE_WORDS[result.profile];
  box.replaceChildren(images, ...ballot(result), h("p", { className: "dim" }, words));
  loadImages(images, result);
  return undefined;
}
