// The takes of the test set as rows, and as CSV.

import { expectedOf, NONE } from "../languages/test-set.js";

/** @import { TestSet } from "../core/types.d.ts" */

/** @typedef {ReturnType<typeof testedOf>[number]} TestedTake */

/** The result of a take that no revision has recognised yet. */
const UNKNOWN = {
  label: null,
  pair: null,
  nearest: null,
  confidence: 0,
  right: false,
  fault: null,
  revision: null,
  recognition_id: null,
};

/**
 * The takes of a test set with their newest results, in natural order (2 before 10); `change` says
 * whether a take is better or worse than with the previous revision.
 *
 * @param {TestSet | null} testSet
 */
export function testedOf(testSet) {
  if (!testSet) return [];
  const { better, worse } = testSet;
  /** @param {string} id */
  const changeOf = (id) => (better.includes(id) ? "better" : worse.includes(id) ? "worse" : null);
  return testSet.takes
    .map(({ result, ...take }) => ({
      ...(result ?? UNKNOWN),
      ...take,
      expected: expectedOf(take) ?? "",
      known: result !== null,
      change: changeOf(take.id),
    }))
    .sort(
      (one, other) =>
        one.clip.localeCompare(other.clip, "en", { numeric: true }) || one.start - other.start,
    );
}

/** @type {(keyof TestedTake)[]} */
const COLUMNS = [
  "clip",
  "start",
  "end",
  "expected",
  "label",
  "nearest",
  "confidence",
  "right",
  "revision",
  "id",
  "pair",
];

/**
 * A value as CSV (RFC 4180); a text that a spreadsheet would read as a formula is marked as text.
 *
 * @param {unknown} value
 * @returns {string}
 */
function field(value) {
  if (Array.isArray(value)) return field(value.join(" or "));
  const text =
    typeof value === "string" && value !== "-"
      ? value.replace(/^[=+\-@\t\r]/, "'$&")
      : String(value ?? "");
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

/**
 * The value of a take in a column of the file.
 *
 * @param {TestedTake} take
 * @param {keyof TestedTake} name
 */
const valueOf = (take, name) => (name === "expected" && take[name] === NONE ? "-" : take[name]);

/**
 * The table of takes as a CSV file.
 *
 * @param {TestedTake[]} takes
 */
export const csvOf = (takes) =>
  [COLUMNS, ...takes.map((take) => COLUMNS.map((name) => valueOf(take, name)))]
    .map((row) => `${row.map(field).join(",")}\r\n`)
    .join("");
