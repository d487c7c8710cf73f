// What is to be expected of each gesture by itself.

import { h } from "../core/dom.js";
import { duration, readable } from "../core/format.js";
import { editLink } from "./finding-links.js";
import { percent, told } from "./rates.js";

/** A rate with a bar of that length and its interval; over the bar it is marked by a sign as well. */
function rate(forecast, bar) {
  if (!forecast) return h("td", { className: "dim" }, "not known");
  const over = bar !== null && forecast.rate > bar;
  return h(
    "td",
    { className: `rate${over ? " over" : ""}`, title: told(forecast) },
    h(
      "span",
      { className: "num" },
      `${percent(forecast.rate)} %`,
      over ? h("b", { title: `above the bar of ${percent(bar)} %` }, " !") : null,
    ),
    h("span", {
      className: "rate-bar",
      "aria-hidden": "true",
      style: { "--share": `${100 * forecast.rate}%` },
    }),
    h("small", { className: "dim num" }, `${percent(forecast.low)} to ${percent(forecast.high)}`),
  );
}

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

function row(gesture, image, bar) {
  const {
    label,
    seconds,
    landmarks,
    missed,
    refused,
    false_alarms: alarms,
    set_off_by: kinds,
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
    rate(missed, bar.missed),
    rate(refused, null),
    rate(alarms, null),
    h(
      "td",
      { className: "set-off" },
      kinds.length ? kinds.join(", ") : h("span", { className: "dim" }, "none of those tried"),
    ),
    seen(landmarks),
    h("td", { className: "edit" }, editLink(label, "Edit")),
  );
}

/** Draw the table of all gestures. */
export function forecastTable({ gestures, bar }, imageOf) {
  const heads = ["Gesture", "Missed", "of it refused", "False alarms", "Set off by", "Seen", ""];
  return h(
    "div",
    { className: "confusion-scroll" },
    h(
      "table",
      { className: "forecasts" },
      h("caption", { className: "visually-hidden" }, "Predicted rates of each gesture"),
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
        gestures.map((gesture) => row(gesture, imageOf(gesture.label), bar)),
      ),
    ),
  );
}
