// The table of what is known of each gesture, measured takes first.

import { h } from "../core/dom.js";
import { duration, readable } from "../core/format.js";
import { compare, editLink } from "./finding-links.js";
import { intervalText, percent } from "./rates.js";

/** @import { CountedRate, GestureHealth, HealthReport, TestSet } from "../core/types.d.ts" */

/** @type {(keyof NonNullable<GestureHealth["counts"]>)[]} */
const COUNTING = ["direction", "tempo", "hand_shape"];
const NEWS = 0.02; // Share from which on a number is worth its place.

/**
 * How many takes were right, with bar and interval; a dash where none is known.
 *
 * @param {CountedRate | null} right
 */
function share(right) {
  if (!right) return h("td", { className: "dim" }, "\u2013");
  const interval = intervalText(right);
  return h(
    "td",
    { className: "rate" },
    h("span", { className: "num" }, `${Math.round(right.rate * right.n)} of ${right.n}`),
    h("span", {
      className: "rate-bar",
      "aria-hidden": "true",
      style: { "--share": `${100 * right.rate}%` },
    }),
    h("small", { className: "dim num" }, interval && `${interval} %`),
  );
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
  if (!landmarks.length) return h("td", { className: "dim" }, "\u2013");
  return h(
    "td",
    {},
    h(
      "ul",
      { className: "seen" },
      landmarks.map(({ landmark, visible }) =>
        h(
          "li",
          {},
          readable(landmark),
          " ",
          h("b", { className: "num" }, `${percent(1 - visible)} %`),
        ),
      ),
    ),
  );
}

/** @param {GestureHealth} gesture */
function nearest({ label, nearest: other }) {
  if (!other) return h("td", { className: "dim" }, "\u2013");
  return h(
    "td",
    { className: "nearest" },
    h(
      "button",
      {
        type: "button",
        className: "link",
        title: `Compare ${label} and ${other.label}`,
        onclick: () => compare(label, other.label),
      },
      other.label,
    ),
    h("small", { className: "dim num" }, ` ${other.distance.toFixed(2)}`),
  );
}

/** @param {GestureHealth["counts"]} counts */
const counting = (counts) =>
  COUNTING.filter((name) => counts?.[name])
    .map(readable)
    .join(", ") || "\u2013";

/**
 * @param {GestureHealth} gesture
 * @param {string} image
 * @param {Node[]} measured
 * @param {Node[]} more
 */
function row(gesture, image, measured, more) {
  const { label, seconds } = gesture;
  return h(
    "tr",
    {},
    h(
      "th",
      { scope: "row" },
      h(
        "div",
        {},
        h("img", { src: image, alt: "", width: 40, height: 40, loading: "lazy" }),
        h(
          "span",
          {},
          label,
          h(
            "small",
            { className: "dim" },
            seconds === null ? "no demonstration" : duration(seconds),
          ),
        ),
      ),
    ),
    measured,
    nearest(gesture),
    more,
    h("td", { className: "edit" }, editLink(label, "Edit")),
  );
}

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
  return h(
    "div",
    { className: "confusion-scroll" },
    h(
      "table",
      { className: "estimates" },
      h("caption", { className: "visually-hidden" }, "What is known of each gesture"),
      h(
        "thead",
        {},
        h(
          "tr",
          {},
          heads.map((text) => h(text ? "th" : "td", text ? { scope: "col" } : {}, text)),
        ),
      ),
      h(
        "tbody",
        {},
        gestures.map((gesture) =>
          row(
            gesture,
            imageOf(gesture.label),
            [
              ...(tested ? [share(testedShare(testSet, gesture.label))] : []),
              ...(forecast.right ? [share(gesture.right)] : []),
            ],
            [
              ...(counts ? [h("td", {}, counting(gesture.counts))] : []),
              ...(misses ? [unseen(gesture)] : []),
            ],
          ),
        ),
      ),
    ),
  );
}
