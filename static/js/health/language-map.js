// The map of the language: similar gestures are close; overlapping thumbnails are moved apart.

import { html, svg } from "../templates.js";

/** @import { HealthReport } from "../core/types.d.ts" */

/** @typedef {{ x: number, y: number }} Point */

const WIDTH = 600;
const HEIGHT = 420;
const ROUNDS = 300; // Of moving apart; thirty thumbnails come to rest within a hundred.
const LABEL = 18; // Height of the line under a thumbnail.
const WIDEST = 1.3; // Of that line, in widths of the thumbnail: as in the style sheet.

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

/**
 * A size at which all thumbnails fit with room to spare.
 *
 * @param {number} count
 */
const sizeOf = (count) =>
  Math.max(30, Math.min(72, Math.sqrt((WIDTH * HEIGHT) / (4 * count)) - LABEL / 2));

/**
 * Scale coordinates to the drawing, by the same factor on both axes.
 *
 * @param {Point[]} places
 * @param {number} margin
 */
function scaled(places, margin) {
  /** @param {"x" | "y"} key */
  const spread = (key) =>
    Math.max(...places.map((place) => place[key])) - Math.min(...places.map((place) => place[key]));
  /** @param {"x" | "y"} key */
  const middle = (key) =>
    (Math.max(...places.map((place) => place[key])) +
      Math.min(...places.map((place) => place[key]))) /
    2;
  const scale = Math.min(
    (WIDTH - 2 * margin) / (spread("x") || 1),
    (HEIGHT - 2 * margin) / (spread("y") || 1),
  );
  return places.map(({ x, y }) => ({
    x: WIDTH / 2 + scale * (x - middle("x")),
    y: HEIGHT / 2 + scale * (y - middle("y")),
  }));
}

/**
 * @param {Point} one
 * @param {Point} other
 * @param {number} index
 * @param {number} width
 * @param {number} height
 */
function pushApart(one, other, index, width, height) {
  const dx = other.x - one.x || 0.01 * (index + 1);
  const dy = other.y - one.y;
  const overlap = { x: width - Math.abs(dx), y: height - Math.abs(dy) };
  if (overlap.x <= 0 || overlap.y <= 0) return;
  const axis = overlap.x < overlap.y ? "x" : "y";
  const way = (Math.sign(axis === "x" ? dx : dy) || 1) * (overlap[axis] / 2);
  one[axis] -= way;
  other[axis] += way;
}

/**
 * Move thumbnails of a size apart, within the drawing, until none covers another.
 *
 * @param {Point[]} places
 * @param {number} size
 */
export function apart(places, size) {
  const moved = places.map((place) => ({ ...place }));
  const [width, height] = [size + 8, size + LABEL + 6];
  for (let round = 0; round < ROUNDS; round += 1) {
    moved.forEach((one, index) =>
      moved.slice(index + 1).forEach((other) => pushApart(one, other, index, width, height)),
    );
    for (const place of moved) {
      const side = Math.max(width, WIDEST * size + 4) / 2;
      place.x = Math.max(side, Math.min(WIDTH - side, place.x));
      place.y = Math.max(height / 2, Math.min(HEIGHT - height / 2, place.y));
    }
  }
  return moved;
}

/**
 * Draw the map. `points` are the report's `map`, `same` the pairs that cannot be told apart, joined
 * by a line; a thumbnail shows the image `imageOf(label)` and calls `open(label)` when pressed.
 *
 * @param {{ points: HealthReport["map"], same: string[][], imageOf: (label: string) => string, open: (label: string) => void }} map
 */
export function languageMap({ points, same, imageOf, open }) {
  const size = sizeOf(points.length);
  const places = scaled(points, size / 2 + LABEL);
  const moved = apart(places, size);
  const at = new Map(points.map(({ label }, index) => [label, moved[index]]));
  const lines = same.flatMap((labels) => {
    const [one, other] = labels.map((label) => at.get(label));
    return one && other ? [svg`<line x1=${one.x} y1=${one.y} x2=${other.x} y2=${other.y} />`] : [];
  });
  const leaders = places.map(
    ({ x, y }, index) =>
      svg`<path class="leader" d="M${x} ${y}L${moved[index].x} ${moved[index].y}" />`,
  );
  /** @param {Point} place */
  const style = ({ x, y }) =>
    `left: ${(100 * x) / WIDTH}%; top: ${(100 * y) / HEIGHT}%; width: ${(100 * size) / WIDTH}%`;
  return html`<div class="map">
    <svg viewBox="0 0 ${WIDTH} ${HEIGHT}" aria-hidden="true">${leaders}${lines}</svg>
    <ul aria-label="Map of the language">
      ${points.map(
        ({ label }, index) =>
          html`<li .style=${style(moved[index])}>
            <button type="button" title=${label} @click=${() => open(label)}>
              <img loading="lazy" src=${imageOf(label)} alt="" /><span>${label}</span>
            </button>
          </li>`,
      )}
    </ul>
  </div>`;
}
