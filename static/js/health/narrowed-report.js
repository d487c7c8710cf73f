// The part of a large language's report that fits a grid and a map: the most confused gestures.

/** @import { HealthReport } from "../core/types.d.ts" */

/** Gestures in the grid and on the map; more cells cannot be told apart. */
export const MOST_SHOWN = 64;

/**
 * Return a report of at most `most` gestures, those of the most confused pairs first, in the
 * language's order. A report that fits is returned as it is.
 *
 * @param {HealthReport} report
 * @param {number} [most]
 */
export function narrow(report, most = MOST_SHOWN) {
  if (report.gestures.length <= most) return report;
  const kept = new Set();
  for (const label of [
    ...report.pairs.flatMap(({ gestures }) => gestures),
    ...report.gestures.map(({ label }) => label),
  ]) {
    if (kept.size === most) break;
    kept.add(label);
  }
  return {
    ...report,
    gestures: report.gestures.filter(({ label }) => kept.has(label)),
    pairs: report.pairs.filter(({ gestures }) => gestures.every((label) => kept.has(label))),
    map: report.map.filter(({ label }) => kept.has(label)),
  };
}
