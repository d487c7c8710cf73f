// The choice of salient keypoints: for each a checkbox, and a bar that shows how far it moves.

import { h, reconcile } from "../core/dom.js";
import { readable } from "../core/format.js";
import { change, draft } from "./gesture-draft.js";

/** @import { DemonstrationFault, Keypoint, Preview } from "../core/types.d.ts" */

/** @typedef {{ keypoints: Pick<Keypoint, "landmark" | "proposed">[], faults?: DemonstrationFault[] }} Proposal */

/**
 * The keypoints that are followed: as chosen, or as proposed.
 *
 * @param {Proposal | null} preview
 */
export function chosenIn(preview) {
  return (
    draft().salient ??
    (preview?.keypoints ?? []).filter((each) => each.proposed).map((each) => each.landmark)
  );
}

/**
 * Switch a keypoint on or off. The last one stays on: a gesture needs at least one.
 *
 * @param {string} landmark
 * @param {Proposal | null} preview
 */
export function toggle(landmark, preview) {
  const chosen = chosenIn(preview);
  const next = chosen.includes(landmark)
    ? chosen.filter((each) => each !== landmark)
    : [...chosen, landmark].sort();
  if (next.length) change({ salient: next });
  return next.length > 0;
}

/**
 * The legend of the bars, or why there are none.
 *
 * @param {Preview | null} preview
 * @param {number} count
 */
function noteOn(preview, count) {
  if (!preview) return "\u2026";
  if (preview.image && !preview.problem && !preview.salient.length) {
    const gesture =
      preview.held_shapes > 1
        ? "two hand shapes one after the other are the gesture"
        : "the shape of the hand is the gesture";
    return `Nothing moves: ${gesture}. To follow a movement instead, choose keypoints.`;
  }
  if (count) {
    const unit = preview.unit === "torso_length" ? "torso lengths" : "shares of the largest extent";
    return `Movement in ${unit}. From the line, ${(preview.threshold ?? 0).toFixed(2)}, a keypoint is proposed.`;
  }
  if (draft().clip)
    return "No keypoint is seen in this range of the clip: choose another range, or another clip.";
  return "Imported without its demonstration: its keypoints cannot be changed. Choose a clip that shows the gesture.";
}

/**
 * Build the list; `draw(preview)` shows what moves.
 *
 * @param {() => Preview | null} latest
 */
export function keypoints(latest) {
  let all = false;
  const list = h("ul", { className: "bars", "aria-label": "Keypoints" });
  const note = h("p", { className: "dim" });
  const problem = h(
    "p",
    { className: "field-problem", role: "alert", hidden: true },
    "At least one keypoint is followed; choose another one first.",
  );
  const every = h("button", {
    type: "button",
    className: "link",
    onclick: () => {
      all = !all;
      draw(latest());
    },
  });
  const proposal = h(
    "button",
    { type: "button", onclick: () => change({ salient: null }) },
    "As proposed",
  );

  /** @param {string} landmark */
  function makeRow(landmark) {
    const input = h("input", {
      type: "checkbox",
      onchange: () => {
        problem.hidden = toggle(landmark, latest());
        draw(latest());
      },
    });
    return h(
      "li",
      {},
      h(
        "label",
        {},
        input,
        h("span", { className: "name" }),
        h(
          "span",
          { className: "bar-track" },
          h("i", { className: "fill" }),
          h("i", { className: "mark" }),
        ),
        h("span", { className: "num" }),
      ),
    );
  }

  /**
   * @param {Keypoint} keypoint
   * @param {HTMLElement | undefined} element
   * @param {number} most
   * @param {number} threshold
   * @param {string[]} chosen
   */
  function row(keypoint, element, most, threshold, chosen) {
    const { landmark, displacement, seen } = keypoint;
    const on = chosen.includes(landmark);
    const drawn = element ?? makeRow(landmark);
    const [input, name, fill, mark, number] = /** @type {[HTMLInputElement, ...HTMLElement[]]} */ (
      ["input", ".name", ".fill", ".mark", ".num"].map((each) => drawn.querySelector(each))
    );
    input.checked = on;
    drawn.classList.toggle("on", on);
    name.textContent = readable(landmark);
    fill.style.width = `${(100 * displacement) / most}%`;
    mark.style.left = `${(100 * threshold) / most}%`;
    number.textContent = displacement.toFixed(2);
    drawn.title = `${readable(landmark)} moves ${displacement.toFixed(2)}${seen < 1 ? `, seen ${Math.round(100 * seen)} % of the time` : ""}${keypoint.proposed ? "; proposed" : ""}`;
    return drawn;
  }

  /** @param {Preview | null} preview */
  function draw(preview) {
    const found = preview?.keypoints ?? [];
    const chosen = chosenIn(preview);
    problem.hidden = problem.hidden || chosen.length > 1;
    const shown = found.filter(
      (each) => all || each.usual || each.proposed || chosen.includes(each.landmark),
    );
    const most =
      Math.max(preview?.threshold ?? 0, ...found.map((each) => each.displacement)) * 1.04 || 1;
    reconcile(
      list,
      shown,
      (each) => each.landmark,
      (each, element) => row(each, element, most, preview?.threshold ?? 0, chosen),
    );
    every.hidden = found.length === 0;
    every.textContent = all ? "Fewer keypoints" : `All ${found.length} keypoints`;
    proposal.disabled = draft().salient === null || !found.length;
    note.textContent = noteOn(preview, found.length);
  }
  return {
    element: h(
      "section",
      { className: "panel keypoints", "aria-label": "Salient keypoints" },
      h("div", { className: "panel-head" }, h("h2", {}, "Salient keypoints"), proposal),
      note,
      list,
      problem,
      every,
    ),
    draw,
  };
}
