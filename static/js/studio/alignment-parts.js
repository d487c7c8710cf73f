// The parts of an alignment that are drawn: the role of its gesture, and the joint.

/** @import { Alignment, Explanation } from "../core/types.d.ts" */

const AT_REST = 0.2; // Share of the largest joint's extent below which a joint rests.

/** @param {number[]} numbers */
export const sum = (numbers) => numbers.reduce((total, each) => total + each, 0);

/**
 * The compared joints, those that differ most from the expected gesture first.
 *
 * @param {Pick<Alignment, "parts" | "costs">} alignment
 */
export function partsOf({ parts, costs }) {
  const totals = parts.map((name, part) => ({
    name,
    part,
    cost: sum(costs.map((step) => step[part])),
  }));
  const whole = sum(totals.map(({ cost }) => cost)) || 1;
  return totals
    .sort((one, other) => other.cost - one.cost)
    .map((each) => ({ ...each, share: each.cost / whole }));
}

/**
 * How far a joint moves in the take, in the alignment's unit.
 *
 * @param {Pick<Alignment, "query">} alignment
 * @param {number} part
 */
function extentOf({ query }, part) {
  const places = query.map((step) => step[part]).filter((place) => place !== null);
  /** @param {0 | 1} axis */
  const spread = (axis) => {
    const values = places.map((place) => place[axis]);
    return values.length ? Math.max(...values) - Math.min(...values) : 0;
  };
  return Math.max(spread(0), spread(1));
}

/**
 * The joint to draw: the one chosen, or else the one drawn before, or else the one that differs
 * most. A joint at rest is drawn only if chosen, because its enlarged tremor looks like a movement.
 *
 * @param {ReturnType<typeof partsOf>} parts
 * @param {Pick<Alignment, "query">[]} alignments
 * @param {string | null} chosen
 * @param {string | null} before
 */
export function chooseJoint(parts, alignments, chosen, before) {
  const named = parts.find(({ name }) => name === chosen);
  if (named) return named;
  const extents = parts.map(({ part }) =>
    Math.max(...alignments.map((each) => extentOf(each, part))),
  );
  const moves = parts.filter((_, index) => extents[index] >= AT_REST * Math.max(...extents));
  return moves.find(({ name }) => name === before) ?? moves[0] ?? parts[0];
}

/**
 * The role of a gesture in an explanation: a rejected take may be nearest to the expected one.
 *
 * @param {string} label
 * @param {Pick<Explanation, "expected" | "nearest">} why
 */
export function roleOf(label, { expected, nearest }) {
  if (label === expected) return "expected";
  return label === nearest ? "nearest" : "runner-up";
}
