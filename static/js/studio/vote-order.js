// The order and the numbers of the vote table: pure functions of a recognition.

import { supportOf } from "./vote-support.js";

/** @import { Recognition } from "../core/types.d.ts" */

/**
 * Whether the gestures are ranked by distance; profile paper and old records rank them by votes.
 *
 * @param {Pick<Recognition, "profile" | "scores">} recognition
 */
export const byDistance = ({ profile, scores }) => profile === "full" && scores.length > 0;

/** Most gestures in the table; farther ones do not help to explain the decision. */
export const MOST_COLUMNS = 40;

/**
 * Distances of one voter as nearness: 1 for the nearest gesture, 0 for the farthest.
 *
 * @param {(number | null)[]} distances
 * @returns {number[]}
 */
export function nearnessOf(distances) {
  const finite = /** @type {number[]} */ (distances.filter((each) => each !== null));
  const [low, high] = [Math.min(...finite), Math.max(...finite)];
  return distances.map((each) =>
    each === null ? 0 : high > low ? (high - each) / (high - low) : 1,
  );
}

/**
 * Rows by descending weight, columns in the ranking of the answer: by distance, or by descending
 * weight of their voters and then by nearness.
 *
 * @param {Pick<Recognition, "profile" | "scores" | "voters" | "gestures" | "distances" | "votes" | "weights">} result
 * @returns {{ rows: number[], columns: number[] }}
 */
export function orderOf(result) {
  const { voters, gestures, distances, weights, scores } = result;
  const support = supportOf(result);
  const near = gestures.map((_, column) =>
    voters.reduce(
      (sum, voter, row) => sum + (weights[voter] ?? 0) * nearnessOf(distances[row])[column],
      0,
    ),
  );
  /**
   * @param {number} one
   * @param {number} other
   */
  const byWeight = (one, other) => (weights[voters[other]] ?? 0) - (weights[voters[one]] ?? 0);
  /**
   * @param {number} one
   * @param {number} other
   */
  const bySupport = (one, other) =>
    (support.get(gestures[other]) ?? 0) - (support.get(gestures[one]) ?? 0) ||
    near[other] - near[one];
  /**
   * @param {number} one
   * @param {number} other
   */
  const byScore = (one, other) => (scores[one] ?? Infinity) - (scores[other] ?? Infinity);
  return {
    rows: voters.map((_, row) => row).sort(byWeight),
    columns: gestures
      .map((_, column) => column)
      .sort(byDistance(result) ? byScore : bySupport)
      .slice(0, MOST_COLUMNS),
  };
}

/**
 * Split rows into voters with weight, and voters without, whose distances had no influence on the
 * decision. A voter whose weight a person changed is always among the former.
 *
 * @param {Pick<Recognition, "voters" | "weights">} result
 * @param {number[]} rows
 * @param {Record<string, number>} factors of the voters' weights
 * @returns {{ heard: number[], silent: number[] }}
 */
export function splitByWeight({ voters, weights }, rows, factors) {
  /** @param {number} row */
  const isHeard = (row) => Boolean(weights[voters[row]]) || (factors[voters[row]] ?? 1) !== 1;
  return { heard: rows.filter(isHeard), silent: rows.filter((row) => !isHeard(row)) };
}

/**
 * A distance in at most four characters, or as many as its size needs.
 *
 * @param {number | null} value
 */
export function shortNumber(value) {
  if (value === null) return "\u221e";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size < 0.001 || size >= 10000) return value.toExponential(0);
  const decimals = size < 0.1 ? 3 : size < 10 ? 2 : size < 100 ? 1 : 0;
  return value.toFixed(decimals).replace(/^0/, "");
}
