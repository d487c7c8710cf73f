// The time cursor over two aligned demonstrations of different duration.

import { h, svg } from "../core/dom.js";
import { moment } from "../core/format.js";
import { bind } from "../core/key-bindings.js";
import { state } from "../core/state.js";
import { iconOf, render } from "../templates.js";

/** @import { PairDifference } from "../core/types.d.ts" */

/** @typedef {{ seconds: number[], cost: number }} Step */

const FREE = 60; // Steps of the cursor if the two cannot be aligned: both advance by equal shares.
const LONGEST = 0.5; // Most seconds of a step while playing; longer rests are cut short.
const HEIGHT = 24; // of the strip, in its own units

/** @type {{ toggle: () => void, step: (by: number) => void, element: HTMLElement } | null} */
let active = null;

/**
 * The steps of the cursor: `{ seconds: [one, other], cost }` each.
 *
 * @param {Pick<PairDifference, "gestures" | "alignment">} pair
 * @returns {Step[]}
 */
export function stepsOf({ gestures, alignment }) {
  if (!alignment) {
    return Array.from({ length: FREE + 1 }, (_, step) => ({
      seconds: gestures.map(({ time }) => ((time.at(-1) ?? 0) * step) / FREE),
      cost: 0,
    }));
  }
  return alignment.pairs.map(([one, other], index) => ({
    seconds: [alignment.time[one], alignment.gesture_time[other]],
    cost: alignment.costs[index].reduce((sum, each) => sum + each, 0),
  }));
}

/**
 * The difference of the two at each step, as a bar.
 *
 * @param {Step[]} steps
 */
function strip(steps) {
  const most = Math.max(...steps.map(({ cost }) => cost));
  if (!most) return null;
  return svg(
    "svg",
    {
      class: "strip",
      viewBox: `0 0 ${steps.length} ${HEIGHT}`,
      preserveAspectRatio: "none",
      role: "img",
      "aria-label": "How much the two differ along the movement",
    },
    ...steps.map(({ cost }, index) =>
      svg("rect", {
        x: index,
        width: 0.85,
        y: HEIGHT * (1 - Math.sqrt(cost / most)),
        height: HEIGHT * Math.sqrt(cost / most),
      }),
    ),
  );
}

/**
 * Make the cursor; `show(step)` is called whenever it moves.
 *
 * @param {Step[]} steps
 * @param {string[]} labels
 * @param {(step: Step) => void} show
 */
export function timeCursor(steps, labels, show) {
  const last = steps.length - 1;
  const slider = h("input", {
    type: "range",
    min: 0,
    max: last,
    step: 1,
    value: 0,
    "aria-label": "Moment of both gestures",
  });
  const clocks = labels.map(() => h("b", { className: "num" }));
  const play = h("button", { type: "button", className: "quiet icon" });
  /** @type {number | undefined} */
  let timer;
  const face = () => {
    const text = timer ? "Pause" : "Play both";
    render(iconOf(timer ? "pause" : "play"), play);
    play.setAttribute("aria-label", text);
    play.title = `${text} (Space)`;
  };
  /** @param {number} to */
  const move = (to) => {
    const step = Math.max(0, Math.min(last, to));
    slider.value = String(step);
    const { seconds } = steps[step];
    seconds.forEach((each, index) => {
      clocks[index].textContent = moment(each);
    });
    slider.setAttribute(
      "aria-valuetext",
      labels.map((label, index) => `${label} at ${moment(seconds[index])}`).join(", "),
    );
    show(steps[step]);
  };
  const stop = () => {
    clearTimeout(timer);
    timer = undefined;
    face();
  };
  const run = () => {
    const now = Number(slider.value);
    if (!slider.isConnected || now >= last) return stop();
    const between = steps[now + 1].seconds.map((each, index) =>
      Math.abs(each - steps[now].seconds[index]),
    );
    timer = setTimeout(
      () => {
        move(now + 1);
        run();
      },
      1000 * Math.min(LONGEST, (between[0] + between[1]) / 2),
    );
    return face();
  };
  const toggle = () => {
    if (timer) return stop();
    if (Number(slider.value) >= last) move(0);
    return run();
  };
  /** @param {number} by */
  const step = (by) => {
    stop();
    move(Number(slider.value) + by);
  };
  slider.oninput = () => {
    stop();
    move(Number(slider.value));
  };
  play.onclick = toggle;
  active = { toggle, step, element: slider };
  face();
  move(0);
  const element = h(
    "div",
    { className: "cursor", role: "group", "aria-label": "Both gestures in time" },
    play,
    h("div", { className: "cursor-track" }, strip(steps), slider),
    h(
      "p",
      { className: "cursor-clock" },
      labels.map((label, index) => h("span", {}, label, " ", clocks[index])),
    ),
  );
  return { element, stop };
}

const shown = () => state.view === "health" && Boolean(active?.element.isConnected);
/**
 * @param {string[]} keys
 * @param {string} text
 * @param {() => void} run
 */
const key = (keys, text, run) =>
  bind({ keys, text, group: "Two gestures side by side", run, when: shown });
key(["Space"], "Play or pause both", () => active?.toggle());
key([","], "One step back", () => active?.step(-1));
key(["."], "One step on", () => active?.step(1));
