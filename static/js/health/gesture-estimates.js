// The table of each gesture's estimated rates.

import { h } from "../core/dom.js";
import { duration, readable } from "../core/format.js";
import { editLink } from "./finding-links.js";
import { anglePlot } from "./angle-plot.js";
import { intervalText, percent, rateText } from "./rates.js";

/** @import { GestureEstimate, HealthReport, Rate } from "../core/types.d.ts" */

/**
 * A rate with its interval; above the threshold it is also marked by a sign.
 *
 * @param {Rate | null} estimate
 * @param {number | null} threshold
 */
function rate(estimate, threshold) {
  if (!estimate) return h("td", { className: "dim" }, "not known");
  const over = threshold !== null && estimate.rate > threshold;
  return h(
    "td",
    { className: `rate${over ? " over" : ""}`, title: rateText(estimate) },
    h(
      "span",
      { className: "num" },
      `${percent(estimate.rate)} %`,
      over ? h("b", { title: `above the threshold of ${percent(threshold)} %` }, " !") : null,
    ),
    h("span", {
      className: "rate-bar",
      "aria-hidden": "true",
      style: { "--share": `${100 * estimate.rate}%` },
    }),
    h("small", { className: "dim num" }, intervalText(estimate)),
  );
}

/** @param {GestureEstimate["landmarks"]} landmarks */
function seen(landmarks) {
  if (!landmarks.length) return h("td", { className: "dim" }, "not known");
  return h(
    "td",
    {},
    h(
      "ul",
      { className: "seen" },
      landmarks.map(({ landmark, visible }) =>
        h("li", {}, readable(landmark), " ", h("b", { className: "num" }, `${percent(visible)} %`)),
      ),
    ),
  );
}

/**
 * @param {GestureEstimate} gesture
 * @param {string} image
 * @param {HealthReport["bar"]} thresholds
 */
function row(gesture, image, thresholds) {
  const {
    label,
    seconds,
    landmarks,
    missed,
    refused,
    false_alarms: alarms,
    set_off_by: kinds,
    angles,
  } = gesture;
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
    rate(missed, thresholds.missed),
    rate(refused, null),
    rate(alarms, null),
    h(
      "td",
      { className: "set-off" },
      kinds.length ? kinds.join(", ") : h("span", { className: "dim" }, "no simulated motion"),
    ),
    h("td", { className: "angles" }, anglePlot(missed, angles, thresholds.missed)),
    seen(landmarks),
    h("td", { className: "edit" }, editLink(label, "Edit")),
  );
}

/**
 * Draw the table of all gestures.
 *
 * @param {HealthReport} report
 * @param {(label: string) => string} imageOf
 */
export function estimateTable({ gestures, bar: thresholds }, imageOf) {
  const heads = [
    "Gesture",
    "Missed",
    "of it rejected",
    "False alarms",
    "False alarms from",
    "When turned",
    "Keypoints seen",
    "",
  ];
  return h(
    "div",
    { className: "confusion-scroll" },
    h(
      "table",
      { className: "estimates" },
      h("caption", { className: "visually-hidden" }, "Estimated rates of each gesture"),
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
        gestures.map((gesture) => row(gesture, imageOf(gesture.label), thresholds)),
      ),
    ),
  );
}
