// The timeline: takes, the playback position, and the selected range.

import { filmstrip } from "../clips/filmstrip.js";
import { byId, h, icon } from "../core/dom.js";
import { moment, plural } from "../core/format.js";
import { LEAST_FRAMES, nearestFrame } from "../clips/frame-times.js";
import { heldName, salutesIn, saluteWarning } from "../clips/salutes.js";
import { isReadable, selectedClip, selectedRange, state, update } from "../core/state.js";
import { seek } from "./playback.js";
import { curves, legend } from "./timeline-curves.js";
import { tracksArea } from "./tracks.js";

/** @import { SelectedRange, Take, Timeline } from "../core/types.d.ts" */

/**
 * @param {number} seconds
 * @param {number} duration
 */
const percent = (seconds, duration) => `${Math.min(100, Math.max(0, (100 * seconds) / duration))}%`;

/** @param {number} duration */
function tickStep(duration) {
  return [0.5, 1, 2, 5, 10, 30, 60, 120].find((step) => duration / step <= 10) ?? 300;
}

/** @param {number} duration */
function ruler(duration) {
  const step = tickStep(duration);
  const ticks = [];
  for (let second = 0; second <= duration - step / 3; second += step) {
    ticks.push(
      h("span", { style: { left: percent(second, duration) } }, `${Number(second.toFixed(1))} s`),
    );
  }
  return h("div", { className: "ruler", "aria-hidden": "true" }, ticks);
}

/**
 * @param {Take} take
 * @param {number} index
 * @param {number} duration
 */
function takeButton(take, index, duration) {
  const chosen = state.take === index;
  const length = take.end - take.start || 1;
  const stroke = h("span", {
    className: "stroke",
    style: {
      left: percent(take.stroke_start - take.start, length),
      width: percent(take.stroke_end - take.stroke_start, length),
    },
  });
  const name = `Take ${index + 1}`;
  return h(
    "button",
    {
      type: "button",
      className: `take${chosen ? " chosen" : ""}${take.closed ? "" : " open"}`,
      "aria-pressed": String(chosen),
      "aria-label": `${name}, ${moment(take.start)} to ${moment(take.end)}${take.closed ? "" : ", no closing salute"}`,
      title: `${name}: from ${held()} to ${held()}. The bright part is the gesture, without the hand's transit from and to it.`,
      style: {
        left: percent(take.start, duration),
        width: percent(take.end - take.start, duration),
      },
      onclick: () => update({ take: index, start: null, end: null, recognition: null }),
    },
    stroke,
    h(
      "span",
      { className: "take-name" },
      h("i", {}, "Take "),
      String(index + 1),
      take.closed ? null : h("small", {}, " open"),
    ),
  );
}

/** What a diver holds before and after a gesture. */
const held = () => heldName(state.gestures);

/**
 * Where a salute opens or closes a take.
 *
 * @param {number} seconds
 * @param {"opens" | "closes"} kind
 * @param {number} duration
 */
function saluteMark(seconds, kind, duration) {
  return h(
    "span",
    {
      className: `salute ${kind}`,
      title: held(),
      style: { left: percent(seconds, duration) },
    },
    icon("salute"),
  );
}

/**
 * @param {Take} take
 * @param {number} duration
 */
const saluteMarks = (take, duration) =>
  [
    saluteMark(take.start, "opens", duration),
    take.closed ? saluteMark(take.end, "closes", duration) : null,
  ].filter((mark) => mark !== null);

/** When the last frame is shown: the right edge of the timeline. */
const timeOfFrames = () => /** @type {Timeline} */ (state.timeline).time;

const lastMoment = () => timeOfFrames().at(-1) || 1;

/**
 * The frame that is nearest to a moment.
 *
 * @param {number} seconds
 */
const frameAt = (seconds) => nearestFrame(timeOfFrames(), seconds);

/**
 * How many frames a key moves a handle on.
 *
 * @type {Record<string, number>}
 */
const WAYS = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 };

/** @param {"start" | "end"} which */
function handle(which) {
  const label = which === "start" ? "Start of the range" : "End of the range";
  const input = h("input", {
    type: "range",
    className: `handle ${which}`,
    min: 0,
    max: lastMoment(),
    step: "any",
    "aria-label": label,
    title: `${label}: drag, or use the arrow keys, frame by frame`,
  });
  /** @param {number} frame */
  const to = (frame) => {
    move(which, frame);
    seek(frame);
  };
  input.oninput = () => to(frameAt(Number(input.value)));
  // The browser's default step is a share of the length, not a frame.
  input.onkeydown = (event) => {
    const way = WAYS[event.key];
    if (!way) return;
    event.preventDefault();
    to(
      Math.min(
        timeOfFrames().length - 1,
        Math.max(0, frameAt(Number(input.value)) + way * (event.shiftKey ? 10 : 1)),
      ),
    );
  };
  return input;
}

/**
 * @param {HTMLElement} track
 * @param {SelectedRange} range
 */
function placeHandles(track, range) {
  for (const which of /** @type {const} */ (["start", "end"])) {
    const input = /** @type {HTMLInputElement} */ (track.querySelector(`.handle.${which}`));
    const frame = frameAt(range[which]);
    input.value = String(timeOfFrames()[frame]);
    input.setAttribute("aria-valuetext", `frame ${frame}, ${moment(range[which])}`);
  }
}

/**
 * Move one end of the range to a frame; from then on it is a range chosen by hand.
 *
 * @param {"start" | "end"} which
 * @param {number} frame
 */
function move(which, frame) {
  const time = timeOfFrames();
  const range = /** @type {SelectedRange} */ (selectedRange());
  const last = time.length - 1;
  const [start, end] = [frameAt(range.start), frameAt(range.end)];
  const moved =
    which === "start"
      ? [
          Math.max(0, Math.min(frame, last - LEAST_FRAMES)),
          Math.max(end, Math.min(last, frame + LEAST_FRAMES)),
        ]
      : [
          Math.min(start, Math.max(0, frame - LEAST_FRAMES)),
          Math.min(last, Math.max(frame, LEAST_FRAMES)),
        ];
  update({ take: null, recognition: null, start: time[moved[0]], end: time[moved[1]] });
}

/** Let the range start, or end, at the frame on display. */
export const setStart = () => {
  if (state.timeline && state.position) move("start", state.position.frame);
};
export const setEnd = () => {
  if (state.timeline && state.position) move("end", state.position.frame);
};

/**
 * @param {SelectedRange} range
 * @param {Take[]} takes
 */
function summary(range, takes) {
  const where = `${moment(range.start)} \u2013 ${moment(range.end)}`;
  if (range.take) {
    const [from, to] = range.shown;
    return `Take ${(state.take ?? 0) + 1} of ${takes.length}: gesture ${moment(from)} \u2013 ${moment(to)}${range.take.closed ? "" : ", without a closing salute"}`;
  }
  if (takes.length) return `Range by hand: ${where}`;
  return `No ${held()} was found; choose the range by hand: ${where}`;
}

/**
 * Let the clock follow the pointer along the thumbnails or curves.
 *
 * @param {HTMLElement} area
 */
function scrub(area) {
  /** @param {PointerEvent} event */
  const to = (event) => {
    const { left, width } = area.getBoundingClientRect();
    seek(frameAt((lastMoment() * (event.clientX - left)) / width));
  };
  area.onpointerdown = (event) => {
    if (event.button !== 0 || /** @type {Element} */ (event.target).closest("button, input"))
      return;
    area.setPointerCapture(event.pointerId);
    to(event);
    area.onpointermove = to;
  };
  area.onpointerup = area.onpointercancel = () => {
    area.onpointermove = null;
  };
}

/**
 * Replace what lies on the track; the handle that is dragged must stay the same element.
 *
 * @param {HTMLElement} track
 * @param {Node[]} content
 * @param {HTMLElement[]} takes
 */
function redrawTrack(track, content, takes) {
  const focused = [...track.querySelectorAll(".take")].findIndex(
    (each) => each === document.activeElement,
  );
  track.querySelectorAll(".take, .range, .salute").forEach((each) => each.remove());
  const film = track.querySelector(".filmstrip");
  if (film) film.after(...content);
  else track.prepend(...content);
  takes[focused]?.focus();
}

/** Draw the timeline of the clip on display. */
export function drawTimeline() {
  const box = byId("timeline");
  const clip = selectedClip();
  const range = /** @type {SelectedRange} */ (selectedRange());
  if (!clip || !isReadable() || !state.takes || !state.timeline) return box.replaceChildren();
  const duration = lastMoment();
  const track = box.querySelector(".track");
  const lengths = h("div", {
    className: "range",
    style: {
      left: percent(range.start, duration),
      width: percent(range.end - range.start, duration),
    },
  });
  const takes = state.takes.map((take, index) => takeButton(take, index, duration));
  // Takes found without a trigger have nothing held at their ends.
  const marked = held() === "gesture" ? [] : state.takes;
  const salutes = marked.flatMap((take) => saluteMarks(take, duration));
  const warning = range.take
    ? ""
    : saluteWarning(salutesIn(state.timeline, range.start, range.end), held());
  const note = h(
    "p",
    { className: "range-text" },
    h("span", { role: "status" }, summary(range, state.takes)),
    warning ? h("span", { className: "salute-warning", role: "alert" }, warning) : null,
    state.take === null && state.takes.length
      ? h(
          "button",
          {
            type: "button",
            className: "link",
            onclick: () => update({ take: 0, start: null, end: null, recognition: null }),
          },
          `Back to ${plural(state.takes.length, "take")}`,
        )
      : null,
  );
  byId("range-text").replaceChildren(note);
  if (track && box.dataset.clip === clip.id) {
    redrawTrack(track, [lengths, ...salutes, ...takes], takes);
    placeHandles(track, range);
    return undefined;
  }
  box.dataset.clip = clip.id;
  const behind = h("div", { className: "curve-area" }, curves(state.timeline));
  const lane = h(
    "div",
    { className: "track", role: "group", "aria-label": "Takes" },
    lengths,
    salutes,
    takes,
    handle("start"),
    handle("end"),
  );
  const along = h(
    "div",
    { className: "along" },
    lane,
    behind,
    tracksArea(),
    h("i", { className: "now", id: "now" }),
  );
  box.replaceChildren(
    along,
    h("div", { className: "under" }, ruler(duration), legend(held().replace("Vulcan ", ""))),
  );
  lane.prepend(filmstrip(clip, state.timeline, lane.clientWidth, lane.clientHeight) ?? "");
  placeHandles(lane, range);
  scrub(along);
  return drawNow();
}

/** Show where the clock stands. */
export function drawNow() {
  const line = document.getElementById("now");
  if (line && state.position && state.timeline)
    line.style.left = percent(state.position.time, lastMoment());
}
