// The rows of the table of takes: which are shown, and in which order.

/** @import { TakeRow } from "../core/types.d.ts" */

/**
 * The rows that a filter leaves: "" all, "rejected", "asked", "faults", or "=LABEL".
 *
 * @param {TakeRow[]} rows
 * @param {string} filter
 */
export function shownRows(rows, filter) {
  if (filter === "rejected")
    return rows.filter(({ take, label, pair }) => take !== null && !label && !pair);
  if (filter === "asked") return rows.filter(({ pair }) => pair);
  if (filter === "faults") return rows.filter(({ faults }) => faults);
  if (filter.startsWith("=")) return rows.filter(({ label }) => label === filter.slice(1));
  return rows;
}

/**
 * The rows in the order of a column; those without a value come last, both up and down.
 *
 * @param {TakeRow[]} rows
 * @param {keyof TakeRow | null} by null: as they came
 * @param {boolean} down
 */
export function sortedRows(rows, by, down) {
  if (!by) return rows;
  const known = rows.filter((row) => row[by] !== null && row[by] !== "");
  const rest = rows.filter((row) => row[by] === null || row[by] === "");
  const sign = down ? -1 : 1;
  /** @type {(one: any, other: any) => number} */
  const compare = (one, other) =>
    typeof one === "number" ? one - other : String(one).localeCompare(String(other));
  return [...known.sort((one, other) => sign * compare(one[by], other[by])), ...rest];
}
