// The preview of a draft: its trajectory image, its descriptors, and its estimated rates.

import { h, svg } from "../core/dom.js";
import { readable } from "../core/format.js";

/** @import { Descriptor, Outlook, Preview, Rate } from "../core/types.d.ts" */

const HEIGHT = 22; // of a descriptor's drawing, in its own units

/** @param {number} share */
const percent = (share) => `${share > 0 && share < 0.01 ? "under 1" : Math.round(100 * share)} %`;

/**
 * A descriptor: bars around a line, or the number itself if there is only one.
 *
 * @param {Descriptor} descriptor
 */
function descriptor({ voter, unit, values }) {
  const most = Math.max(...values.map(Math.abs)) || 1;
  const bars = values.map((value, index) => {
    const size = (HEIGHT / 2) * (Math.abs(value) / most);
    return svg("rect", {
      x: index,
      width: 0.7,
      y: value < 0 ? HEIGHT / 2 : HEIGHT / 2 - size,
      height: Math.max(0.3, size),
    });
  });
  return h(
    "li",
    { title: `${readable(voter)}: distances in ${unit}` },
    h("span", { className: "name" }, readable(voter)),
    values.length === 1
      ? h("span", { className: "num" }, values[0].toFixed(3))
      : svg(
          "svg",
          {
            viewBox: `0 0 ${values.length} ${HEIGHT}`,
            preserveAspectRatio: "none",
            role: "img",
            "aria-label": `${values.length} numbers, the largest ${most.toFixed(2)}`,
          },
          ...bars,
        ),
  );
}

/** Build the image and descriptors. */
export function image() {
  const drawing = h("img", {
    className: "trajectory",
    alt: "Trajectory image of the gesture, from the dot along the arrow",
    width: 224,
    height: 224,
    hidden: true,
  });
  const nothing = h("p", {}, "Nothing to draw yet");
  const problem = h("p", { className: "field-problem", role: "alert", hidden: true });
  const list = h("ul", { className: "descriptors", "aria-label": "Descriptors" });
  const described = h(
    "details",
    { open: true, hidden: true },
    h("summary", {}, "Descriptors of the image"),
    list,
  );
  const length = h("small", { className: "dim num" });
  /** @param {Preview | null} preview */
  function draw(preview) {
    if (!preview) return;
    problem.hidden = !preview.problem;
    problem.textContent = preview.problem
      ? `It cannot be saved like this: ${preview.problem}.`
      : "";
    drawing.classList.toggle("stale", Boolean(preview.problem));
    length.textContent = preview.seconds === null ? "" : `${preview.seconds.toFixed(2)} s`;
    if (preview.image) {
      Object.assign(drawing, { src: preview.image, hidden: false });
      nothing.hidden = true;
    }
    described.hidden = !preview.descriptors.length;
    list.replaceChildren(...preview.descriptors.map(descriptor));
  }
  return {
    element: h(
      "section",
      { className: "panel image-panel", "aria-label": "Trajectory image" },
      h("div", { className: "panel-head" }, h("h2", {}, "Trajectory image"), length),
      h("div", { className: "image-box" }, nothing, drawing),
      problem,
      described,
    ),
    draw,
  };
}

/**
 * An estimated rate as a bar, a number and a mark.
 *
 * @param {string | HTMLElement} words
 * @param {Rate} share
 * @param {number} threshold
 * @param {Rate | null | undefined} before
 */
function rateRow(words, share, threshold, before) {
  const bad = share.rate > threshold;
  const was =
    before && percent(before.rate) !== percent(share.rate)
      ? h("small", { className: "dim" }, ` (saved: ${percent(before.rate)})`)
      : null;
  return h(
    "li",
    {
      className: bad ? "bad" : "good",
      title: `95 %: ${percent(share.low)} to ${percent(share.high)}`,
    },
    h(
      "span",
      {
        className: "verdict",
        role: "img",
        "aria-label": bad ? "Above the threshold" : "Below the threshold",
      },
      bad ? "!" : "\u2713",
    ),
    h("span", {}, words, was),
    h("b", { className: "num" }, percent(share.rate)),
    h(
      "span",
      { className: "bar-track" },
      h("i", { className: "fill", style: { width: `${100 * Math.min(1, share.rate)}%` } }),
      h("i", { className: "mark", style: { left: `${100 * threshold}%` } }),
    ),
  );
}

/**
 * @param {Outlook} found
 * @param {Rate} missed
 * @param {Outlook | null} before
 */
function rows(found, missed, before) {
  /** @param {string} label */
  const earlier = (label) => before?.pairs.find((pair) => pair.gestures[1] === label)?.confusion;
  return [
    rateRow(
      "Missed: recognised as another gesture, or rejected",
      missed,
      found.most_missed,
      before?.missed,
    ),
    ...found.pairs.flatMap((pair) =>
      !pair.confusion
        ? []
        : rateRow(
            h(
              "span",
              {},
              "Confused with ",
              h("b", {}, pair.gestures[1]),
              pair.distance === null
                ? ""
                : h("small", { className: "dim" }, ` distance ${pair.distance.toFixed(2)}`),
            ),
            pair.confusion,
            found.most_confusion,
            earlier(pair.gestures[1]),
          ),
    ),
  ];
}

/**
 * Build the estimated rates; `draw(found, before)` compares them with the saved gesture's.
 *
 * @param {string} name
 */
export function health(name) {
  const list = h("ul", { className: "estimates", "aria-label": "Estimated rates" });
  const note = h("p", { className: "dim", role: "status" });
  /**
   * @param {Outlook | null} found
   * @param {Outlook | null} before
   * @param {string | null | undefined} problem
   */
  function draw(found, before, problem) {
    list.classList.toggle("stale", !found);
    if (!found) {
      note.textContent = problem
        ? "Nothing can be estimated before the gesture is complete."
        : "Simulating trials\u2026";
      return;
    }
    const { missed } = found;
    note.textContent =
      missed === null
        ? "Without a demonstration no trials can be simulated: choose a clip that shows the gesture."
        : found.pairs.length
          ? "Estimated for another diver from simulated trials, with the nearest gestures. The line is the threshold of the health report."
          : "The only gesture of a language cannot be confused with another.";
    list.replaceChildren(...(missed === null ? [] : rows(found, missed, before)));
  }
  return {
    element: h(
      "section",
      { className: "panel health-panel", "aria-label": "Health" },
      h("h2", {}, `Health of ${name} with it`),
      note,
      list,
    ),
    draw,
  };
}
