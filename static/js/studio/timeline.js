// The timeline: takes, the playback position, and the selected range.

import { filmstrip } from "../clips/filmstrip.js";
import { byId, h, icon } from "../core/dom.js";
import { moment, plural } from "../core/format.js";
import { LEAST_FRAMES, nearestFrame } from "../clips/frame-times.js";
import { heldName, salutesIn, saluteWarning } from "../clips/salutes.js";
import { isReadable, selectedClip, selectedRange, state, update } from "../core/state.js";
import { keepFrame, seek } from "./playback.js";
import { curves, legend } from "./timeline-curves.js";
import { tracksArea } from "./tracks.js";

/** @import { SelectedRange, Take, Timeline } from "../core/types.d.ts" */

/**
 * @param {number} seconds
 * @param {number} duration
 */
const percent = (seconds, duration) => `${Math.min(100, Math.max(0, (100 * seconds) / duration))}%`;

const LEAST_SECONDS = 0.5; // in sight at the largest zoom
const SALUTES_ROOM = 76; // px between two takes, for the salutes of both
const MOST_ZOOM = 40; // Each screenful of it has thumbnails of its own.

let zoom = 1; // The timeline's width, as a multiple of its room.

/** @type {(part: number, whole: number) => string} */
const share = (part, whole) => `${(100 * part) / whole}%`;

/**
 * Make the overview of a timeline that scrolls; a press or a drag moves the part in sight.
 *
 * @param {HTMLElement} seen
 */
function overview(seen) {
  const bar = h("div", { className: "overview", "aria-hidden": "true", hidden: true });
  /** @param {PointerEvent} event */
  const to = (event) => {
    const { left, width } = bar.getBoundingClientRect();
    seen.scrollLeft = (seen.scrollWidth * (event.clientX - left)) / width - seen.clientWidth / 2;
  };
  bar.onpointerdown = (event) => {
    bar.setPointerCapture(event.pointerId);
    to(event);
    bar.onpointermove = to;
  };
  bar.onpointerup = bar.onpointercancel = () => {
    bar.onpointermove = null;
  };
  seen.addEventListener("scroll", () => drawInSight(seen, bar));
  return bar;
}

/**
 * Show which part is in sight.
 *
 * @param {HTMLElement} seen
 * @param {HTMLElement} bar
 */
function drawInSight(seen, bar) {
  const part = /** @type {HTMLElement | null} */ (bar.querySelector(".in-sight"));
  if (!part) return;
  part.style.left = share(seen.scrollLeft, seen.scrollWidth);
  part.style.width = share(seen.clientWidth, seen.scrollWidth);
}

/**
 * Draw the overview where the timeline is enlarged.
 *
 * @param {HTMLElement} box of the timeline
 * @param {Take[]} takes
 * @param {number} last second of the clip
 * @param {boolean} enlarged
 */
function drawOverview(box, takes, last, enlarged) {
  const [bar, seen] = [".overview", ".seen"].map(
    (each) => /** @type {HTMLElement | null} */ (box.querySelector(each)),
  );
  if (!bar || !seen) return;
  bar.hidden = !enlarged;
  bar.replaceChildren(
    ...takes.map(({ start, end }) =>
      h("i", { style: { left: share(start, last), width: share(end - start, last) } }),
    ),
    h("i", { className: "in-sight" }),
  );
  drawInSight(seen, bar);
}

/** @param {number} duration */
function ruler(duration) {
  const least = duration / zoom / 10; // Ten fit into what is in sight.
  const step = [0.1, 0.5, 1, 2, 5, 10, 30, 60, 120].find((each) => each >= least) ?? 300;
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
    h("span", { className: "take-name" }, String(index + 1)),
  );
}

/** What a diver holds before and after a gesture. */
const held = () => heldName(state.gestures);

/**
 * Where a salute opens and where one closes a take.
 *
 * @param {Take} take
 * @param {number} duration
 */
const saluteMarks = ({ start, end, closed }, duration) =>
  [["opens", start], ...(closed ? [["closes", end]] : [])].map(([kind, seconds]) =>
    h(
      "span",
      {
        className: `salute ${kind}`,
        title: held(),
        style: { left: percent(Number(seconds), duration) },
      },
      icon("salute"),
    ),
  );

/**
 * Where too little was seen: no gesture is read across it.
 *
 * @param {number[]} span
 * @param {number} duration
 */
const unseen = ([start, end], duration) =>
  h("span", {
    className: "unseen",
    role: "img",
    "aria-label": `Not seen, ${moment(start)} to ${moment(end)}`,
    title: "Too little was seen here: a salute may have been missed.",
    style: { left: percent(start, duration), width: percent(end - start, duration) },
  });

/** When the last frame is shown: the right edge of the timeline. */
const timeOfFrames = () => /** @type {Timeline} */ (state.timeline).time;

const lastMoment = () => timeOfFrames().at(-1) || 1;

/** @param {number} seconds */
const frameAt = (seconds) => nearestFrame(timeOfFrames(), seconds);

/** @type {Record<string, number>} how many frames a key moves a handle on */
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

/**
 * Let the range start, or end, at the frame on display; a clip that plays goes on.
 *
 * @param {"start" | "end"} which
 */
function moveHere(which) {
  if (!state.timeline || !state.position) return;
  const { frame } = state.position;
  if (frameAt(/** @type {SelectedRange} */ (selectedRange())[which]) === frame) return;
  keepFrame();
  move(which, frame);
}
export const setStart = () => moveHere("start");
export const setEnd = () => moveHere("end");

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
  track.querySelectorAll(".take, .range, .salute, .unseen").forEach((each) => each.remove());
  const film = track.querySelector(".filmstrip");
  if (film) film.after(...content);
  else track.prepend(...content);
  takes[focused]?.focus();
}

/**
 * Say what is selected, and warn of salutes in it.
 *
 * @param {SelectedRange} range
 * @param {Take[]} takes
 */
function drawNote(range, takes) {
  const inside = salutesIn(/** @type {Timeline} */ (state.timeline), range.start, range.end);
  const warning = range.take ? "" : saluteWarning(inside, held());
  const back = () => update({ take: 0, start: null, end: null, recognition: null });
  byId("range-text").replaceChildren(
    h(
      "p",
      { className: "range-text" },
      h("span", { role: "status" }, summary(range, takes)),
      warning ? h("span", { className: "salute-warning", role: "alert" }, warning) : null,
      state.take === null && takes.length
        ? h(
            "button",
            { type: "button", className: "link", onclick: back },
            `Back to ${plural(takes.length, "take")}`,
          )
        : null,
    ),
  );
}

/** Draw the timeline of the clip on display. */
export function drawTimeline() {
  const box = byId("timeline");
  const clip = selectedClip();
  const range = /** @type {SelectedRange} */ (selectedRange());
  if (!clip || !isReadable() || !state.takes || !state.timeline) return box.replaceChildren();
  const duration = lastMoment();
  const track = box.querySelector(".track");
  const [left, width] = [range.start, range.end - range.start].map((part) =>
    percent(part, duration),
  );
  const lengths = h("div", { className: "range", style: { left, width } });
  const takes = state.takes.map((take, index) => takeButton(take, index, duration));
  // Takes found without a trigger have nothing held at their ends.
  const marked = held() === "gesture" ? [] : state.takes;
  const second = (track?.clientWidth ?? 0) / duration;
  const salutes = marked
    .filter(({ start }, index) => second * (start - (marked[index - 1]?.end ?? 0)) > SALUTES_ROOM)
    .flatMap((take) => saluteMarks(take, duration));
  const holes = state.timeline.unseen.map((span) => unseen(span, duration));
  drawNote(range, state.takes);
  drawOverview(box, state.takes, duration, zoom > 1);
  // While a clip is being read, its end moves.
  const drawn = `${clip.id} ${duration}`;
  if (track && box.dataset.clip === drawn) {
    redrawTrack(track, [lengths, ...salutes, ...takes, ...holes], takes);
    placeHandles(track, range);
    return undefined;
  }
  box.dataset.clip = drawn;
  zoom = 1;
  const lane = h(
    "div",
    { className: "track", role: "group", "aria-label": "Takes" },
    lengths,
    salutes,
    takes,
    holes,
    handle("start"),
    handle("end"),
  );
  const along = h(
    "div",
    { className: "along" },
    lane,
    h("div", { className: "labelled-ranges", id: "labelled-ranges" }),
    h("div", { className: "curve-area" }, curves(state.timeline)),
    tracksArea(),
    h("i", { className: "now", id: "now" }),
  );
  const zoomed = h("div", { className: "zoomed" }, along, ruler(duration));
  const seen = h("div", { className: "seen" }, zoomed);
  // A pinch on a touchpad arrives as a wheel with Ctrl.
  seen.addEventListener("wheel", (event) => {
    if (!event.ctrlKey) return;
    event.preventDefault();
    zoomBy(2 ** (-event.deltaY / 200), event.clientX);
  });
  box.replaceChildren(
    overview(seen),
    seen,
    h(
      "div",
      { className: "under" },
      ZOOMS.map(({ sign, key, text: title, zoom: onclick }) =>
        h(
          "button",
          { type: "button", "aria-label": title, title: `${title} (${key})`, onclick },
          sign,
        ),
      ),
      legend(held().replace("Vulcan ", "")),
    ),
  );
  placeHandles(lane, range);
  scrub(along);
  zoomBy(1);
  return drawNow();
}

/**
 * Enlarge the timeline about a place of the screen, or about the moment on display.
 *
 * @param {number} factor
 * @param {number} [clientX]
 */
function zoomBy(factor, clientX) {
  const clip = selectedClip();
  const [seen, zoomed, track] = [".seen", ".zoomed", ".track"].map(
    (each) => /** @type {HTMLElement | null} */ (byId("timeline").querySelector(each)),
  );
  if (!seen || !zoomed || !track || !clip || !state.timeline) return;
  const { left, width } = zoomed.getBoundingClientRect();
  const place = clientX ?? left + (width * (state.position?.time ?? 0)) / lastMoment();
  const share = (place - left) / width;
  const inSight = place - seen.getBoundingClientRect().left;
  zoom = Math.max(1, Math.min(MOST_ZOOM, lastMoment() / LEAST_SECONDS, zoom * factor));
  zoomed.style.width = `${100 * zoom}%`;
  seen.scrollLeft = share * zoomed.clientWidth - Math.min(seen.clientWidth, Math.max(0, inSight));
  zoomed.querySelector(".ruler")?.replaceWith(ruler(lastMoment()));
  track.querySelector(".filmstrip")?.remove();
  track.prepend(filmstrip(clip, state.timeline, track.clientWidth, track.clientHeight) ?? "");
  drawTimeline();
}

/** Show where the clock stands. */
export function drawNow() {
  const line = document.getElementById("now");
  if (!line || !state.position || !state.timeline) return;
  line.style.left = percent(state.position.time, lastMoment());
  const seen = line.closest(".seen");
  const beyond = seen ? line.offsetLeft - seen.scrollLeft : 0;
  if (seen && (beyond < 0 || beyond > seen.clientWidth))
    seen.scrollLeft = line.offsetLeft - seen.clientWidth / 4;
}

/** The buttons and keys that zoom. */
export const ZOOMS = [
  { sign: "\u2212", key: "-", text: "Show more of the timeline", zoom: () => zoomBy(0.5) },
  { sign: "+", key: "+", text: "Enlarge the timeline", zoom: () => zoomBy(2) },
];
