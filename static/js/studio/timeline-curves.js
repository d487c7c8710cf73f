// The curves under the timeline: the salute's confidence and the wrists' speed.

import { SALUTE } from "../clips/salute-threshold.js";
import { html, svg } from "../templates.js";

/** @import { Timeline } from "../core/types.d.ts" */

const HEIGHT = 30; // of the drawing, in its own units

const CURVES = [
  { name: "right_wrist", className: "right", text: "right wrist\u2019s speed" },
  { name: "left_wrist", className: "left", text: "left wrist\u2019s speed" },
];

/**
 * The path of a line through `values`, interrupted where one is missing.
 *
 * @param {(number | null)[]} values
 * @param {number} top
 * @param {(index: number) => string} share
 */
export function linePath(values, top, share) {
  let down = false;
  return values
    .map((value, index) => {
      if (value === null) {
        down = false;
        return "";
      }
      const y = (HEIGHT * (1 - Math.min(1, value / top))).toFixed(2);
      const command = `${down ? "L" : "M"}${share(index)} ${y}`;
      down = true;
      return command;
    })
    .join("");
}

/**
 * The largest speed of ordinary frames: a jumping landmark must not flatten the rest.
 *
 * @param {Pick<Timeline, "speed">} timeline
 */
export function topSpeed(timeline) {
  const values = CURVES.flatMap(({ name }) => timeline.speed[name])
    .filter((value) => value !== null)
    .sort((one, other) => one - other);
  return Math.max(0.5, values[Math.floor(0.98 * (values.length - 1))] ?? 0);
}

/**
 * The curves, over the same width as the takes.
 *
 * @param {Timeline} timeline
 */
export function curves(timeline) {
  const { time, salute, speed, unit } = timeline;
  const last = time.at(-1) || 1;
  /** @param {number} index */
  const share = (index) => ((1000 * time[index]) / last).toFixed(1);
  const top = topSpeed(timeline);
  const tops = salute.map(
    (value, index) => `L${share(index)} ${(HEIGHT * (1 - value)).toFixed(2)}`,
  );
  const area = `M0 ${HEIGHT}${tops.join("")}L1000 ${HEIGHT}Z`;
  const length = unit === "torso_length" ? "torso lengths" : "extents";
  return html`<div class="curves" title="Highest speed: ${top.toFixed(1)} ${length} a second">
    <svg
      viewBox="0 0 1000 ${HEIGHT}"
      preserveAspectRatio="none"
      role="img"
      aria-label="Salute’s confidence and the wrists’ speed along the clip"
    >
      <path class="salute-area" d=${area} />
      <path class="salute-bar" d="M0 ${HEIGHT * (1 - SALUTE)}H1000" />
      ${CURVES.map(
        ({ name, className }) =>
          svg`<path class=${className} d=${linePath(speed[name], top, share)} />`,
      )}
    </svg>
  </div>`;
}

/**
 * The legend of the curves.
 *
 * @param {string} held what begins and ends a take
 */
export const legend = (held) =>
  html`<ul class="curve-legend" aria-label="Curves">
    <li><i class="salute-area"></i>${held}</li>
    ${CURVES.map(({ className, text }) => html`<li><i class=${className}></i>${text}</li>`)}
  </ul>`;
