// The wrists that move in a range of a clip, and their places over time.

/** @import { Poses } from "../core/types.d.ts" */

const STILL = 0.5; // Share of the larger wrist's path below which a wrist is no part of the stroke.
const WRISTS = ["left_wrist", "right_wrist"];

/** @param {number[]} values */
const spread = (values) => (values.length ? Math.max(...values) - Math.min(...values) : 0);

/**
 * The coordinates of a landmark along one axis, without the frames in which it was not seen.
 *
 * @param {(number | null)[][]} places
 * @param {0 | 1} axis
 */
const seenAlong = (places, axis) =>
  places.map((place) => place[axis]).filter((value) => value !== null);

/**
 * Where a landmark is in every frame.
 *
 * @param {Pick<Poses, "landmarks" | "xy">} poses
 * @param {string} name
 */
function placesOf({ landmarks, xy }, name) {
  const at = landmarks.indexOf(name);
  return at < 0 ? [] : xy.map((points) => points[at]);
}

/**
 * The wrists that move in a range of frames.
 *
 * @param {Pick<Poses, "landmarks" | "xy">} poses
 * @param {[number, number]} range
 */
export function movingWrists(poses, [first, last]) {
  const extents = WRISTS.map((name) => {
    const places = placesOf(poses, name).slice(first, last + 1);
    return Math.max(spread(seenAlong(places, 0)), spread(seenAlong(places, 1)));
  });
  const most = Math.max(...extents);
  return WRISTS.filter((_, index) => extents[index] > 0 && extents[index] >= STILL * most);
}

/**
 * The tracks of landmarks: per landmark x (to the right) and y (upwards) in every frame, as shares
 * 0 to 1 of the largest extent of all, so that they are comparable; null where it was not seen.
 *
 * @param {Pick<Poses, "landmarks" | "xy">} poses
 * @param {string[]} names
 * @returns {{ name: string, x: (number | null)[], y: (number | null)[] }[]}
 */
export function tracksOf(poses, names) {
  const known = names.map((name) => ({ name, places: placesOf(poses, name) }));
  const extent =
    Math.max(
      ...known.flatMap(({ places }) => [
        spread(seenAlong(places, 0)),
        spread(seenAlong(places, 1)),
      ]),
    ) || 1;
  return known.map(({ name, places }) => {
    const [left, bottom] = [Math.min(...seenAlong(places, 0)), Math.max(...seenAlong(places, 1))];
    return {
      name,
      x: places.map(([x]) => (x === null ? null : (x - left) / extent)),
      y: places.map(([, y]) => (y === null ? null : (bottom - y) / extent)),
    };
  });
}
