// Which interventions are offered as remedies, and in which order, by an explanation.

/** @import { Counterfactual, Explanation, Recognition } from "../core/types.d.ts" */

const LEAST_KEPT = 0.8; // Share of the stroke that a trim keeps; a shorter part is another gesture.

/**
 * From what teaches most to what fits one take only: another demonstration adds evidence, weights
 * are fitted to this take, and a demonstration that is replaced is recognised by construction.
 */
const ORDER = [
  "further_demonstration",
  "switch",
  "salient",
  "trim",
  "keypoint_repair",
  "profile",
  "simplification",
  "voter_weight",
  "demonstration",
];

/** @type {(found: Counterfactual) => number} */
const rankOf = ({ change }) => {
  const rank = ORDER.indexOf(change.kind);
  return rank < 0 ? ORDER.length : rank;
};

/** @type {(found: Counterfactual) => boolean} */
const breaksNothing = ({ effect }) => !effect || !effect.lost.length;

/** Whether a trim keeps most of the stroke that was recognised. */
function keepsStroke({ change }, { start, end }) {
  if (change.kind !== "trim") return true;
  const kept = Math.min(end, change.end) - Math.max(start, change.start);
  return kept >= LEAST_KEPT * (end - start);
}

/**
 * The interventions to offer, the best first.
 *
 * @param {Pick<Explanation, "counterfactuals">} why
 * @param {Pick<Recognition, "start" | "end">} result
 * @returns {Counterfactual[]}
 */
export const offeredOf = (why, result) =>
  why.counterfactuals
    .filter((each) => breaksNothing(each) && keepsStroke(each, result))
    .sort((one, other) => rankOf(one) - rankOf(other));

/**
 * What to show differently: the difference that explains most, with its moment; null without one.
 *
 * @param {{ differences: Record<string, any>[] }} why
 * @returns {{ words: string, start: number | null } | null}
 */
export function lessonOf({ differences }) {
  const strongest = [...differences].sort((one, other) => other.share - one.share).at(0);
  return strongest ? { words: strongest.words, start: strongest.start } : null;
}
