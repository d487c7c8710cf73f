// Rates as text.

/** @import { LimitCosts, Rate, Replacement, TestSet } from "../core/types.d.ts" */

/**
 * A rate in per cent, rounded half to even, as in the texts of the findings. A rate
 * above 0 is never written as 0.
 *
 * @param {number} rate
 */
export function percent(rate) {
  const hundredths = 100 * rate;
  const nearest = Math.round(hundredths);
  const rounded = nearest - hundredths === 0.5 && nearest % 2 ? nearest - 1 : nearest;
  return rate > 0 && rounded === 0 ? "<1" : String(rounded);
}

/**
 * The interval of a rate in words; empty where both of its ends read the same.
 *
 * @param {Pick<Rate, "low" | "high">} rate
 */
export const intervalText = ({ low, high }) =>
  percent(low) === percent(high) ? "" : `${percent(low)} to ${percent(high)}`;

/**
 * A rate in words, with its interval.
 *
 * @param {Rate} rate
 */
export function rateText(rate) {
  const interval = intervalText(rate);
  return `${percent(rate.rate)} %${interval && ` (${interval})`}`;
}

/**
 * The rate of tested takes in words, or how many of them cannot be tested: the rate of a part of
 * the takes would rise by what leaves the test.
 *
 * @param {Pick<TestSet["overall"], "untestable" | "rate" | "low" | "high">} share
 */
export function testedText({ untestable, rate, low, high }) {
  if (untestable) return `, ${untestable} cannot be tested`;
  return rate === null || low === null || high === null ? "" : `, ${rateText({ rate, low, high })}`;
}

/**
 * What the limit of a language costs, a sentence each.
 *
 * @param {LimitCosts} limit
 */
export function costWords({ people, measured, refused, accepted }) {
  if (people < 2)
    return [
      "One person has shown this language. The limit is a cautious constant: ask two more people.",
    ];
  return [
    measured ? "" : "Too few gestures are shown by two people: the limit is a cautious constant.",
    refused ? `Of ${refused.n} right takes by other people, ${rateText(refused)} are refused.` : "",
    accepted
      ? `Of ${accepted.n} takes of missing gestures, ${rateText(accepted)} are accepted.`
      : "",
  ].filter(Boolean);
}

/**
 * How far another movement would be from the other gestures, in one sentence or two.
 *
 * @param {Pick<Replacement, "nearest" | "alike">} replacement
 */
export function effectText({ nearest, alike }) {
  const pairs = alike.map(({ gestures }) => gestures.join(" and ")).join(", ");
  const still = pairs && ` Nearly alike: ${pairs}.`;
  return nearest ? `Nearest is ${nearest.gestures[1]}: ${nearest.words}.${still}` : still;
}
