// The takes of a clip along its time, and the range that the buttons act on.

import { byId, h, icon } from "./dom.js";
import { moment, plural } from "./format.js";
import { lengthOf, selectedClip, selectedRange, state, update } from "./state.js";

const LEAST_RANGE = 0.1; // s. Three frames: with fewer there is no gesture.

const percent = (seconds, duration) => `${Math.min(100, Math.max(0, (100 * seconds) / duration))}%`;

function tickStep(duration) {
  return [0.5, 1, 2, 5, 10, 30, 60, 120].find((step) => duration / step <= 10) ?? 300;
}

function ruler(duration) {
  const step = tickStep(duration);
  const ticks = [];
  for (let second = 0; second <= duration - step / 3; second += step) {
    ticks.push(h("span", { style: { left: percent(second, duration) } }, `${Number(second.toFixed(1))} s`));
  }
  return h("div", { className: "ruler", "aria-hidden": "true" }, ticks);
}

function takeButton(take, index, duration) {
  const chosen = state.take === index;
  const length = take.end - take.start || 1;
  const stroke = h("span", { className: "stroke", style: { left: percent(take.stroke_start - take.start, length), width: percent(take.stroke_end - take.stroke_start, length) } });
  const name = `Take ${index + 1}`;
  return h("button", {
    type: "button",
    className: `take${chosen ? " chosen" : ""}${take.closed ? "" : " open"}`,
    "aria-pressed": String(chosen),
    "aria-label": `${name}, ${moment(take.start)} to ${moment(take.end)}${take.closed ? "" : ", no closing salute"}`,
    title: `${name}: from salute to salute. The bright part is the gesture, without the hand's way from and to the salute.`,
    style: { left: percent(take.start, duration), width: percent(take.end - take.start, duration) },
    onclick: () => update({ take: index, start: null, end: null, recognition: null }),
  }, stroke, h("span", { className: "take-name" }, name, take.closed ? null : h("small", {}, " open")));
}

/** Where a salute opens or closes a take. */
function saluteMark(seconds, kind, duration) {
  return h("span", { className: `salute ${kind}`, title: "Vulcan salute", style: { left: percent(seconds, duration) } }, icon("salute"));
}

const saluteMarks = (take, duration) => [
  saluteMark(take.start, "opens", duration),
  take.closed ? saluteMark(take.end, "closes", duration) : null,
].filter(Boolean);

function handle(which, range, duration) {
  const label = which === "start" ? "Start of the range" : "End of the range";
  const input = h("input", { type: "range", className: `handle ${which}`, min: 0, max: duration.toFixed(3), step: 0.01, "aria-label": label, title: `${label}: drag, or use the arrow keys` });
  input.value = range[which].toFixed(2);
  input.setAttribute("aria-valuetext", moment(range[which]));
  input.oninput = () => move(which, Number(input.value), duration);
  return input;
}

/** Move one end of the range; from then on it is a range chosen by hand. */
function move(which, value, duration) {
  const { start, end } = selectedRange();
  const moved = which === "start"
    ? { start: Math.max(0, Math.min(value, end - LEAST_RANGE)), end }
    : { start, end: Math.min(duration, Math.max(value, start + LEAST_RANGE)) };
  update({ take: null, recognition: null, ...moved });
}

function summary(range, takes) {
  const where = `${moment(range.start)} \u2013 ${moment(range.end)}`;
  if (range.take) {
    const [from, to] = range.shown;
    return `Take ${state.take + 1} of ${takes.length}: gesture ${moment(from)} \u2013 ${moment(to)}${range.take.closed ? "" : ", never closed by a salute"}`;
  }
  if (takes.length) return `Range by hand: ${where}`;
  return `No Vulcan salute was found, so the range is yours to choose: ${where}`;
}

/** Draw the timeline of the clip on display. */
export function drawTimeline() {
  const box = byId("timeline");
  const clip = selectedClip();
  const range = selectedRange();
  const duration = clip ? lengthOf(clip) : 0;
  if (!duration || clip.status !== "done" || !state.takes) return box.replaceChildren();
  const track = box.querySelector(".track");
  const lengths = h("div", { className: "range", style: { left: percent(range.start, duration), width: percent(range.end - range.start, duration) } });
  const takes = state.takes.map((take, index) => takeButton(take, index, duration));
  const salutes = state.takes.flatMap((take) => saluteMarks(take, duration));
  const note = h("p", { className: "range-text" },
    h("span", { role: "status" }, summary(range, state.takes)),
    state.take === null && state.takes.length
      ? h("button", { type: "button", className: "link", onclick: () => update({ take: 0, start: null, end: null, recognition: null }) }, `Back to ${plural(state.takes.length, "take")}`)
      : null);
  if (track && box.dataset.clip === clip.id) {
    // The handle being dragged must stay the same element.
    const focused = track.querySelector(".take:focus") ? [...track.querySelectorAll(".take")].indexOf(document.activeElement) : -1;
    track.querySelectorAll(".take, .range, .salute").forEach((each) => each.remove());
    track.prepend(lengths, ...salutes, ...takes);
    if (focused >= 0) takes[focused]?.focus();
    for (const which of ["start", "end"]) {
      const input = track.querySelector(`.handle.${which}`);
      input.value = range[which].toFixed(2);
      input.setAttribute("aria-valuetext", moment(range[which]));
    }
    box.querySelector(".range-text").replaceWith(note);
    return undefined;
  }
  box.dataset.clip = clip.id;
  return box.replaceChildren(
    h("div", { className: "track", role: "group", "aria-label": "Takes" }, lengths, salutes, takes, handle("start", range, duration), handle("end", range, duration)),
    ruler(duration),
    note);
}
