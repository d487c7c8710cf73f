// The curve of takes read right, over the number of people who have shown the language.

import { h, svg } from "../core/dom.js";
import { follow } from "../core/state.js";
import { percent, rateText } from "./rates.js";

/** @import { Forecast } from "../core/types.d.ts" */

const WIDTH = 460;
const HEIGHT = 180;
const LEFT = 46;
const RIGHT = 14;
const TOP = 8;
const BOTTOM = 22;
const MOST = 7; // people: eight show a language, of whom one is left out
const SHARES = [0, 0.5, 1];

/** @param {number} people */
export const across = (people) => LEFT + ((people - 1) / (MOST - 1)) * (WIDTH - LEFT - RIGHT);

/** @param {number} share */
export const up = (share) => TOP + (1 - share) * (HEIGHT - TOP - BOTTOM);

/** @param {[number, number][]} points */
const path = (points) => `M${points.map(([x, y]) => `${x.toFixed(1)} ${y.toFixed(1)}`).join("L")}`;

/**
 * The curve with its interval, from two points on.
 *
 * @param {Forecast["curve"]} curve
 */
function peopleCurve(curve) {
  /** @type {(key: "rate" | "low" | "high") => [number, number][]} */
  const line = (key) => curve.map((point) => [across(point.people), up(point[key])]);
  const words = curve.map(({ people, ...rate }) => `${people}: ${rateText(rate)}`).join(", ");
  return h(
    "figure",
    {},
    svg(
      "svg",
      {
        viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
        role: "img",
        "aria-label": `Read right of people who have not shown it, by the number who have: ${words}`,
      },
      ...SHARES.map((share) =>
        svg(
          "g",
          { class: "grid" },
          svg("path", { d: `M${LEFT} ${up(share)}H${WIDTH - RIGHT}` }),
          svg(
            "text",
            { x: LEFT - 8, y: up(share) + 4, "text-anchor": "end" },
            `${percent(share)} %`,
          ),
        ),
      ),
      svg("path", { class: "band", d: `${path([...line("low"), ...line("high").reverse()])}Z` }),
      svg("path", { class: "line", d: path(line("rate")) }),
      ...curve.map(({ people, rate }) =>
        svg("circle", { class: "point", cx: across(people), cy: up(rate), r: 3.5 }),
      ),
      ...Array.from({ length: MOST }, (_, index) =>
        svg(
          "text",
          { x: across(index + 1), y: HEIGHT - 6, "text-anchor": "middle" },
          `${index + 1}`,
        ),
      ),
    ),
    h(
      "figcaption",
      { className: "dim" },
      "Takes read right, from people who have not shown the language. Across: how many others have. Band: 95 % interval.",
    ),
  );
}

/** Make the part of the health view with the curve, and keep it in step with the report. */
export function curvePart() {
  const part = h("div", { className: "people-curve", hidden: true });
  let drawn = "";
  follow(["gestures", "health"], ({ gestures, health }) => {
    const report = gestures && health?.id === gestures.id ? health.report : null;
    const curve = report?.forecast.curve ?? [];
    part.hidden = curve.length < 2;
    part.classList.toggle("stale", health?.status !== "done");
    const now = JSON.stringify(curve);
    if (now === drawn || part.hidden) return;
    drawn = now;
    part.replaceChildren(peopleCurve(curve));
  });
  return part;
}
