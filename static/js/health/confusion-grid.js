// A confusion matrix: a grid whose cells are walked by the arrow keys and opened by Enter.

import { h } from "../core/dom.js";

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

/**
 * @param {HTMLTableElement} table
 * @param {KeyboardEvent} event
 */
function walk(table, event) {
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

/** @param {Cell} cell */
function drawCell({ text, amount, label, className = "", open = null }) {
  return h(
    "td",
    {
      role: "gridcell",
      tabIndex: -1,
      className: `${className}${open ? " opens" : ""}`,
      "aria-label": label,
      title: label,
      style: { "--amount": `${(STRONGEST * Math.sqrt(amount)).toFixed(1)}%` },
      onclick: open,
    },
    text,
  );
}

/**
 * @param {"rowheader" | "columnheader"} role
 * @param {Head} head
 */
const head = (role, { label, image }) =>
  h(
    "th",
    { role, scope: role === "rowheader" ? "row" : "col", title: label },
    h(
      "div",
      {},
      image ? h("img", { src: image, alt: "", width: 32, height: 32, loading: "lazy" }) : null,
      h("span", {}, label),
    ),
  );

/**
 * Make a grid. `rows` and `columns` are `{ label, image }`; `cell(row, column)` gets their indices
 * and returns `{ text, amount, label, className, open }`, `amount` in [0, 1].
 *
 * @param {{ label: string, corner: string, rows: Head[], columns: Head[], cell: (row: number, column: number) => Cell }} grid
 */
export function confusionGrid({ label, corner, rows, columns, cell }) {
  const table = h(
    "table",
    {
      role: "grid",
      className: `confusion${columns.length > MANY ? " many" : ""}`,
      "aria-label": label,
    },
    h(
      "thead",
      {},
      h(
        "tr",
        { role: "row" },
        h("th", { role: "columnheader", className: "corner" }, corner),
        columns.map((column) => head("columnheader", column)),
      ),
    ),
    h(
      "tbody",
      {},
      rows.map((row, index) =>
        h(
          "tr",
          { role: "row" },
          head("rowheader", row),
          columns.map((_, column) => drawCell(cell(index, column))),
        ),
      ),
    ),
  );
  const first =
    /** @type {HTMLElement | null} */ (table.querySelector("td.opens")) ??
    table.querySelector("td");
  if (first) first.tabIndex = 0;
  table.onkeydown = (event) => walk(table, event);
  return h("div", { className: "confusion-scroll" }, table);
}
