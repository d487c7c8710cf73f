// The choice of the salient keypoints: a bar each for how far it moves, with a checkbox.

import { h, reconcile } from "../core/dom.js";
import { readable } from "../core/format.js";
import { change, draft } from "./gesture-draft.js";

/** The keypoints that are followed: as chosen, or as proposed. */
export function chosenIn(preview) {
  return (
    draft().salient ??
    (preview?.keypoints ?? []).filter((each) => each.proposed).map((each) => each.landmark)
  );
}

/** Switch a keypoint on or off. The last one stays: without any there is no gesture. */
export function toggle(landmark, preview) {
  const chosen = chosenIn(preview);
  const next = chosen.includes(landmark)
    ? chosen.filter((each) => each !== landmark)
    : [...chosen, landmark].sort();
  if (next.length) change({ salient: next });
  return next.length > 0;
}

/** What the bars mean, or why there are none. */
function noteOn(preview, count) {
  if (!preview) return "\u2026";
  if (count) {
    const unit = preview.unit === "torso_length" ? "torso lengths" : "shares of the largest extent";
    return `Movement in ${unit}. From the line, ${preview.threshold.toFixed(2)}, a keypoint is proposed.`;
  }
  if (draft().clip)
    return "No keypoint is seen in this range of the clip: choose another range, or another clip.";
  return "Imported without its demonstration: its keypoints cannot be changed. Choose a clip that shows the gesture.";
}

/** Build the list; `draw(preview)` shows what moves. */
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

  function row(keypoint, element, most, threshold, chosen) {
    const { landmark, displacement, seen } = keypoint;
    const on = chosen.includes(landmark);
    if (!element) {
      const input = h("input", {
        type: "checkbox",
        onchange: () => {
          problem.hidden = toggle(landmark, latest());
          draw(latest());
        },
      });
      element = h(
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
    element.querySelector("input").checked = on;
    element.classList.toggle("on", on);
    element.querySelector(".name").textContent = readable(landmark);
    element.querySelector(".fill").style.width = `${(100 * displacement) / most}%`;
    element.querySelector(".mark").style.left = `${(100 * threshold) / most}%`;
    element.querySelector(".num").textContent = displacement.toFixed(2);
    element.title = `${readable(landmark)} moves ${displacement.toFixed(2)}${seen < 1 ? `, seen ${Math.round(100 * seen)} % of the time` : ""}${keypoint.proposed ? "; proposed" : ""}`;
    return element;
  }

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
      (each, element) => row(each, element, most, preview.threshold, chosen),
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
