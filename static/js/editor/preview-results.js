// The preview of a draft: its trajectory image, its descriptors, and the gestures near it.

import { h, svg } from "../core/dom.js";
import { readable } from "../core/format.js";

/** @import { Descriptor, Outlook, Preview } from "../core/types.d.ts" */

const HEIGHT = 22; // of a descriptor's drawing, in its own units

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
    { hidden: true },
    h("summary", {}, "Descriptors of the image"),
    list,
  );
  const length = h("small", { className: "dim num" });
  const strokes = h("p", { className: "strokes", hidden: true });
  /** @param {Preview | null} preview */
  function draw(preview) {
    if (!preview) return;
    problem.hidden = !preview.problem;
    problem.textContent = preview.problem
      ? `It cannot be saved like this: ${preview.problem}.`
      : "";
    drawing.classList.toggle("stale", Boolean(preview.problem));
    length.textContent = preview.seconds === null ? "" : `${preview.seconds.toFixed(2)} s`;
    strokes.textContent = `Strokes: ${preview.strokes}`;
    strokes.hidden = !preview.strokes;
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
      strokes,
      problem,
      described,
    ),
    draw,
  };
}

/** @typedef {NonNullable<Outlook["nearest"]>[number]} NearGesture */

/**
 * A gesture near the edited one, with a mark where the two cannot be told apart.
 *
 * @param {NearGesture} near
 * @param {NearGesture | undefined} before
 */
function nearRow({ label, distance, same }, before) {
  const was =
    before && before.distance.toFixed(2) !== distance.toFixed(2)
      ? h("small", { className: "dim" }, ` (saved: ${before.distance.toFixed(2)})`)
      : null;
  return h(
    "li",
    { className: same ? "bad" : "good" },
    h(
      "span",
      {
        className: "verdict",
        role: "img",
        "aria-label": same ? "The robot cannot distinguish the two" : "Another movement",
      },
      same ? "!" : "\u2713",
    ),
    h("span", {}, h("b", {}, label), was),
    h("b", { className: "num" }, distance.toFixed(2)),
  );
}

/**
 * Build the list of near gestures; `draw(found, before)` compares them with the saved gesture's.
 *
 * @param {string} name
 */
export function health(name) {
  const list = h("ul", { className: "estimates", "aria-label": "Nearest gestures" });
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
        ? "Nothing can be compared before the gesture is complete."
        : "Comparing\u2026";
      return;
    }
    const { nearest } = found;
    note.textContent =
      nearest === null
        ? "Without a demonstration nothing can be compared: choose a clip that shows the gesture."
        : nearest.length
          ? "Distance of the nearest gestures, 1 for two typical ones. What other people reach is measured once three have shown the language."
          : "The only gesture of a language cannot be confused with another.";
    list.replaceChildren(
      ...(nearest ?? []).map((near) =>
        nearRow(
          near,
          before?.nearest?.find(({ label }) => label === near.label),
        ),
      ),
    );
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
