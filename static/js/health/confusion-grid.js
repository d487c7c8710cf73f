// A confusion matrix: a grid whose cells are walked by the arrow keys and opened by Enter.

import { html, live } from "../templates.js";

/** @typedef {{ label: string, image?: string }} Head */

/** @typedef {{ text: string, amount: number, label: string, className?: string, open?: (() => void) | null }} Cell */

const MANY = 12; // Columns; with more, their names are written upwards to fit the page.
const STRONGEST = 55; // Per cent of the accent in a full cell; its number must stay readable.

/** @type {Record<string, [number, number]>} */
const STEPS = {
  ArrowLeft: [0, -1],
  ArrowRight: [0, 1],
  ArrowUp: [-1, 0],
  ArrowDown: [1, 0],
  Home: [0, -Infinity],
  End: [0, Infinity],
};

/** @param {KeyboardEvent} event */
function walk(event) {
  const table = /** @type {HTMLTableElement} */ (event.currentTarget);
  const target = /** @type {HTMLElement} */ (event.target);
  const cells = [...table.tBodies[0].rows].map(
    (row) => /** @type {HTMLElement[]} */ ([...row.querySelectorAll("[role=gridcell]")]),
  );
  const row = cells.findIndex((each) => each.includes(target));
  if (row < 0) return;
  const column = cells[row].indexOf(target);
  if (event.key === "Enter" || event.key === " ") {
    event.preventDefault();
    target.click();
    return;
  }
  const step = STEPS[event.key];
  if (!step || event.ctrlKey || event.altKey || event.metaKey) return;
  event.preventDefault();
  /**
   * @param {number} value
   * @param {number} count
   */
  const within = (value, count) => Math.max(0, Math.min(count - 1, value));
  const next =
    cells[within(row + step[0], cells.length)][within(column + step[1], cells[row].length)];
  target.tabIndex = -1;
  next.tabIndex = 0;
  next.focus();
}

/**
 * @param {Cell} cell
 * @param {boolean} first
 */
const drawCell = ({ text, amount, label, className = "", open = null }, first) =>
  html`<td
    role="gridcell"
    .tabIndex=${live(first ? 0 : -1)}
    class="${className}${open ? " opens" : ""}"
    aria-label=${label}
    title=${label}
    .style=${`--amount: ${(STRONGEST * Math.sqrt(amount)).toFixed(1)}%`}
    @click=${open}
  >
    ${text}
  </td>`;

/** @param {Head} head */
const content = ({ label, image }) =>
  html`<div>
    ${image ? html`<img loading="lazy" src=${image} alt="" width="32" height="32" />` : ""}<span
      >${label}</span
    >
  </div>`;

/**
 * Draw a grid. `rows` and `columns` are `{ label, image }`; `cell(row, column)` gets their indices
 * and returns `{ text, amount, label, className, open }`, `amount` in [0, 1].
 *
 * @param {{ label: string, corner: string, rows: Head[], columns: Head[], cell: (row: number, column: number) => Cell }} grid
 */
export function confusionGrid({ label, corner, rows, columns, cell }) {
  const cells = rows.map((_, row) => columns.map((_, column) => cell(row, column)));
  const first = cells.flat().find(({ open }) => open) ?? cells[0]?.[0];
  return html`<div class="confusion-scroll">
    <table
      role="grid"
      class="confusion ${columns.length > MANY ? "many" : ""}"
      aria-label=${label}
      @keydown=${walk}
    >
      <thead>
        <tr role="row">
          <th role="columnheader" class="corner">${corner}</th>
          ${columns.map(
            (each) =>
              html`<th role="columnheader" scope="col" title=${each.label}>${content(each)}</th>`,
          )}
        </tr>
      </thead>
      <tbody>
        ${rows.map(
          (row, index) =>
            html`<tr role="row">
              <th role="rowheader" scope="row" title=${row.label}>${content(row)}</th>
              ${cells[index].map((each) => drawCell(each, each === first))}
            </tr>`,
        )}
      </tbody>
    </table>
  </div>`;
}
