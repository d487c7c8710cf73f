// The polar plot of a gesture: how often it is recognised when the diver is turned.

import { h, svg } from "../core/dom.js";
import { percent, rateText } from "./rates.js";

/** @import { GestureEstimate, Rate } from "../core/types.d.ts" */

const RADIUS = 30;

/**
 * The end of the ray at an angle, seen from above: 0 points straight down, towards the camera; a
 * diver turned to their own left points to the right of the picture.
 */
function place(/** @type {number} */ degrees, /** @type {number} */ share) {
  const angle = (degrees * Math.PI) / 180;
  return [RADIUS * share * Math.sin(angle), RADIUS * share * Math.cos(angle)].map(
    (value) => Math.round(10 * value) / 10,
  );
}

/** The alternative text of the plot. */
export function anglesInWords(/** @type {GestureEstimate["angles"]} */ angles) {
  return angles
    .map(({ degrees, missed, read_as: other }) => {
      const side = degrees > 0 ? "left" : "right";
      const instead = other ? `, read as ${other}` : "";
      return `${Math.abs(degrees)}\u00b0 ${side}: missed in ${rateText(missed)}${instead}`;
    })
    .join("\n");
}

/**
 * Draw the share of recognised takes at every angle; angles beyond the threshold are marked.
 * @param {Rate | null} missed straight ahead
 * @param {GestureEstimate["angles"]} angles
 * @param {number} threshold
 */
export function anglePlot(missed, angles, threshold) {
  if (!missed || !angles.length)
    return h("span", { className: "dim", title: "its demonstration has no depth" }, "not known");
  const around = [...angles, { degrees: 0, missed, read_as: null }].sort(
    (one, other) => one.degrees - other.degrees,
  );
  const outline = around.map(({ degrees, missed: { rate } }) => place(degrees, 1 - rate));
  const worst = around.reduce((one, other) => (other.missed.rate > one.missed.rate ? other : one));
  return svg(
    "svg",
    {
      class: "angle-plot",
      viewBox: `${-RADIUS - 2} -3 ${2 * RADIUS + 4} ${RADIUS + 6}`,
      width: 2 * RADIUS + 4,
      height: RADIUS + 6,
      role: "img",
      "aria-label": `Missed most at ${worst.degrees}\u00b0, in ${percent(worst.missed.rate)} %`,
    },
    svg("title", {}, anglesInWords(angles)),
    svg("path", { class: "reach", d: `M${-RADIUS} 0A${RADIUS} ${RADIUS} 0 0 0 ${RADIUS} 0Z` }),
    svg("path", { class: "recognised", d: `M0 0L${outline.map((at) => at.join(" ")).join("L")}Z` }),
    ...around
      .filter(({ missed: { rate } }) => rate > threshold)
      .map(({ degrees }) => {
        const [x, y] = place(degrees, 1);
        return svg("circle", { class: "over", cx: x, cy: y, r: 2 });
      }),
  );
}
