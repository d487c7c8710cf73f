// The curve of takes read right, over the number of people who have shown the language.

import { html, svg } from "../templates.js";
import { percent, rateText } from "./rates.js";

/** @import { Forecast } from "../core/types.d.ts" */

const WIDTH = 460;
const HEIGHT = 180;
const LEFT = 46;
const RIGHT = 14;
const TOP = 8;
const BOTTOM = 22;
const MOST = 7; // people: eight show a language, of whom one is left out
const SHARES = [0, 0.5, 1];
const PEOPLE = Array.from({ length: MOST }, (_, index) => index + 1);

/** @param {number} people */
export const across = (people) => LEFT + ((people - 1) / (MOST - 1)) * (WIDTH - LEFT - RIGHT);

/** @param {number} share */
export const up = (share) => TOP + (1 - share) * (HEIGHT - TOP - BOTTOM);

/** @param {[number, number][]} points */
const path = (points) => `M${points.map(([x, y]) => `${x.toFixed(1)} ${y.toFixed(1)}`).join("L")}`;

/**
 * The curve with its interval, from two points on.
 *
 * @param {Forecast["curve"]} curve
 */
function peopleCurve(curve) {
  /** @type {(key: "rate" | "low" | "high") => [number, number][]} */
  const line = (key) => curve.map((point) => [across(point.people), up(point[key])]);
  const words = curve.map(({ people, ...rate }) => `${people}: ${rateText(rate)}`).join(", ");
  return html`<figure>
    <svg
      viewBox="0 0 ${WIDTH} ${HEIGHT}"
      role="img"
      aria-label="Read right of people who have not shown it, by the number who have: ${words}"
    >
      ${SHARES.map(
        (share) => svg`<g class="grid">
          <path d="M${LEFT} ${up(share)}H${WIDTH - RIGHT}" />
          <text x=${LEFT - 8} y=${up(share) + 4} text-anchor="end">${percent(share)} %</text>
        </g>`,
      )}
      <path class="band" d="${path([...line("low"), ...line("high").reverse()])}Z" />
      <path class="line" d=${path(line("rate"))} />
      ${curve.map(
        ({ people, rate }) =>
          svg`<circle class="point" cx=${across(people)} cy=${up(rate)} r="3.5" />`,
      )}
      ${PEOPLE.map(
        (people) =>
          svg`<text x=${across(people)} y=${HEIGHT - 6} text-anchor="middle">${people}</text>`,
      )}
    </svg>
    <figcaption class="dim">
      Takes read right, from people who have not shown the language. Across: how many others have.
      Band: 95 % interval.
    </figcaption>
  </figure>`;
}

/**
 * The part of the health view with the curve; hidden below two points.
 *
 * @param {Forecast["curve"]} curve
 * @param {string} stale the class of what is of an older revision
 */
export const curvePart = (curve, stale) =>
  html`<div class="people-curve ${stale}" ?hidden=${curve.length < 2}>
    ${curve.length < 2 ? "" : peopleCurve(curve)}
  </div>`;
