// The table of what is known of each gesture, measured takes first.

import { duration, readable } from "../core/format.js";
import { buttonOf, html } from "../templates.js";
import { compare, editLink } from "./finding-links.js";
import { intervalText, percent } from "./rates.js";

/** @import { CountedRate, GestureHealth, HealthReport, TestSet } from "../core/types.d.ts" */

/** @type {(keyof NonNullable<GestureHealth["counts"]>)[]} */
const COUNTING = ["direction", "tempo", "hand_shape"];
const NEWS = 0.02; // Share from which on a number is worth its place.

const UNKNOWN = html`<td class="dim">–</td>`;

/**
 * How many takes were right, with bar and interval; a dash where none is known.
 *
 * @param {CountedRate | null} right
 */
function share(right) {
  if (!right) return UNKNOWN;
  const interval = intervalText(right);
  return html`<td class="rate">
    <span class="num">${Math.round(right.rate * right.n)} of ${right.n}</span
    ><span class="rate-bar" aria-hidden="true" .style=${`--share: ${100 * right.rate}%`}></span
    ><small class="dim num">${interval && `${interval} %`}</small>
  </td>`;
}

/**
 * The takes of a gesture in the test set; null without any.
 *
 * @param {TestSet | null} testSet
 * @param {string} gesture
 * @returns {CountedRate | null}
 */
export function testedShare(testSet, gesture) {
  const found = testSet?.gestures.find(({ label }) => label === gesture);
  if (!found || found.rate === null || found.low === null || found.high === null) return null;
  return { rate: found.rate, low: found.low, high: found.high, n: found.asked };
}

/**
 * The keypoints that are missing often enough to matter.
 *
 * @param {GestureHealth} gesture
 */
const missing = ({ landmarks }) => landmarks.filter(({ visible }) => 1 - visible > NEWS);

/** @param {GestureHealth} gesture */
function unseen(gesture) {
  const landmarks = missing(gesture);
  if (!landmarks.length) return UNKNOWN;
  return html`<td>
    <ul class="seen">
      ${landmarks.map(
        ({ landmark, visible }) =>
          html`<li>${readable(landmark)} <b class="num">${percent(1 - visible)} %</b></li>`,
      )}
    </ul>
  </td>`;
}

/** @param {GestureHealth} gesture */
function nearest({ label, nearest: other }) {
  if (!other) return UNKNOWN;
  return html`<td class="nearest">
    ${buttonOf(other.label, () => compare(label, other.label), {
      look: "link",
      title: `Compare ${label} and ${other.label}`,
    })}<small class="dim num"> ${other.distance.toFixed(2)}</small>
  </td>`;
}

/** @param {GestureHealth["counts"]} counts */
const counting = (counts) =>
  COUNTING.filter((name) => counts?.[name])
    .map(readable)
    .join(", ") || "\u2013";

/**
 * @param {GestureHealth} gesture
 * @param {string} image
 * @param {unknown} measured
 * @param {unknown} more
 */
const row = (gesture, image, measured, more) =>
  html`<tr>
    <th scope="row">
      <div>
        <img loading="lazy" src=${image} alt="" width="40" height="40" /><span
          >${gesture.label}<small class="dim"
            >${gesture.seconds === null ? "no demonstration" : duration(gesture.seconds)}</small
          ></span
        >
      </div>
    </th>
    ${measured}${nearest(gesture)}${more}
    <td class="edit">${editLink(gesture.label, "Edit")}</td>
  </tr>`;

/**
 * Draw the table of all gestures; columns that would tell nothing of any are left out.
 *
 * @param {HealthReport} report
 * @param {TestSet | null} testSet
 * @param {(label: string) => string} imageOf
 */
export function gestureTable({ gestures, forecast }, testSet, imageOf) {
  const tested = Boolean(testSet?.overall.asked);
  const counts = gestures.some((gesture) => COUNTING.some((name) => gesture.counts?.[name]));
  const misses = gestures.some((gesture) => missing(gesture).length);
  const heads = [
    "Gesture",
    ...(tested ? ["Test set"] : []),
    ...(forecast.right ? ["Read right by the others\u2019 demonstrations"] : []),
    "Nearest gesture",
    ...(counts ? ["Counts beside the figure"] : []),
    ...(misses ? ["Keypoints not seen"] : []),
    "",
  ];
  return html`<div class="confusion-scroll">
    <table class="estimates">
      <caption class="visually-hidden">
        What is known of each gesture
      </caption>
      <thead>
        <tr>
          ${heads.map((text) => (text ? html`<th scope="col">${text}</th>` : html`<td></td>`))}
        </tr>
      </thead>
      <tbody>
        ${gestures.map((gesture) =>
          row(
            gesture,
            imageOf(gesture.label),
            [
              tested ? share(testedShare(testSet, gesture.label)) : "",
              forecast.right ? share(gesture.right) : "",
            ],
            [
              counts ? html`<td>${counting(gesture.counts)}</td>` : "",
              misses ? unseen(gesture) : "",
            ],
          ),
        )}
      </tbody>
    </table>
  </div>`;
}
