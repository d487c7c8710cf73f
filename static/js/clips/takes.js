// Takes as a table: of the test with clips, of practice, of an invitation, or of chosen clips.

import { askWhich } from "../core/format.js";
import { address, go, here } from "../core/views.js";
import { html } from "../templates.js";

/** @import { State } from "../core/types.d.ts" */

/**
 * How a take was read; `right` is whether it is the gesture that it shows.
 *
 * @typedef {{ right: boolean, label: string | null, pair: string[] | null }} Answer
 */

export const REFUSED = "refused";
export const ASKED = "asked back";

/** @param {Pick<Answer, "label" | "pair">} take */
export const readAs = ({ label, pair }) => label ?? (pair ? ASKED : REFUSED);

/**
 * The order of a take among others: the wrong ones come first, then those that were asked back.
 *
 * @param {Pick<Answer, "right" | "pair">} take
 */
export const rankOf = ({ right, pair }) => (right ? 2 : pair ? 1 : 0);

/**
 * How a take was read, with its sign; `extra` is what else is known about it, in words.
 *
 * @param {Answer} take
 * @param {string} [extra]
 */
export function answerOf(take, extra = "") {
  const [sign, word] = [
    ["\u2260", "wrong: "],
    ["?", "asked back: "],
    ["\u2713", "right: "],
  ][rankOf(take)];
  return html`<span class="outcome-sign" aria-hidden="true">${sign}</span><span>${word}</span
    ><b>${take.pair ? askWhich(take.pair) : readAs(take)}</b>${
      extra && html`<small class="dim">, ${extra}</small>`
    }`;
}

/**
 * The name of a take as a link to it in the studio.
 *
 * @param {string} name
 * @param {Partial<State>} place
 * @param {() => unknown} [open]
 */
export const takeLink = (name, place, open = () => go("studio", place)) =>
  html`<a href=${address("studio", place)} title="Show the clip and why" @click=${here(open)}
    >${name}</a
  >`;

/**
 * The row of a take with one cell for each column.
 *
 * @param {unknown[]} cells
 * @param {string} [look]
 */
export const takeRow = (cells, look = "") =>
  html`<tr class=${look}>
    ${cells.map((cell) => html`<td>${cell}</td>`)}
  </tr>`;

/**
 * A table of takes, whose columns have these heads.
 *
 * @param {string} caption
 * @param {unknown[]} heads
 * @param {unknown} rows
 */
export const takesTable = (caption, heads, rows) =>
  html`<div class="takes-scroll">
    <table class="takes">
      <caption class="visually-hidden">
        ${caption}
      </caption>
      <thead>
        <tr>
          ${heads}
        </tr>
      </thead>
      <tbody>
        ${rows}
      </tbody>
    </table>
  </div>`;

/**
 * The heads of columns; one of buttons has no name.
 *
 * @param {string[]} names
 */
export const headsOf = (names) =>
  names.map((name) => (name ? html`<th scope="col">${name}</th>` : html`<td></td>`));
