// The part of a large language's report that fits a map: the gestures that are nearest to another.

/** @import { HealthReport } from "../core/types.d.ts" */

/** Gestures on the map; more cannot be told apart. */
export const MOST_SHOWN = 64;

/**
 * Return the places of at most `most` gestures, those that are nearest to another one.
 *
 * @param {Pick<HealthReport, "gestures" | "map">} report
 * @param {number} [most]
 */
export function narrow({ gestures, map }, most = MOST_SHOWN) {
  const kept = new Set(
    [...gestures]
      .sort(
        (one, other) => (one.nearest?.distance ?? Infinity) - (other.nearest?.distance ?? Infinity),
      )
      .slice(0, most)
      .map(({ label }) => label),
  );
  return map.filter(({ label }) => kept.has(label));
}
