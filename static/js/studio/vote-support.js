// The support of a recognition: per gesture, the weight of the voters that chose it. Voters that
// cannot compare the take have no vote, and their weight does not count.

/** @import { Recognition } from "../core/types.d.ts" */

/**
 * @param {Pick<Recognition, "votes" | "weights">} recognition
 * @returns {Map<string, number>}
 */
export function supportOf({ votes, weights }) {
  /** @type {Map<string, number>} */
  const totals = new Map();
  for (const [voter, label] of Object.entries(votes))
    if (label !== null && weights[voter])
      totals.set(label, (totals.get(label) ?? 0) + weights[voter]);
  const whole = [...totals.values()].reduce((sum, each) => sum + each, 0);
  return new Map([...totals].map(([label, total]) => [label, total / whole]));
}
