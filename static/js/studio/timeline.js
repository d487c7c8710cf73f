// The timeline: takes, the playback position, and the selected range.

import { filmstrip } from "../clips/filmstrip.js";
import { byId } from "../core/dom.js";
import { moment, plural } from "../core/format.js";
import { LEAST_FRAMES, nearestFrame } from "../clips/frame-times.js";
import { heldName, salutesIn, saluteWarning } from "../clips/salutes.js";
import { isReadable, selectedClip, selectedRange, state, update } from "../core/state.js";
import { keepFrame, seek } from "./playback.js";
import { guard, html, iconOf, live, nothing, render } from "../templates.js";
import { curves, legend } from "./timeline-curves.js";

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

/** @type {HTMLElement | null} */
let film = null; // the thumbnails, as wide as the track

/**
 * The place of a span of the clip along the timeline.
 *
 * @param {number} start
 * @param {number} end
 * @param {number} duration
 */
const spanning = (start, end, duration) =>
  `left: ${percent(start, duration)}; width: ${percent(end - start, duration)}`;

/**
 * Call `to` where the pointer was pressed, and wherever it is dragged.
 *
 * @param {PointerEvent & { currentTarget: any }} event
 * @param {(area: HTMLElement, event: PointerEvent) => void} to
 */
function drag(event, to) {
  const area = event.currentTarget;
  area.setPointerCapture(event.pointerId);
  to(area, event);
  area.onpointermove = (/** @type {PointerEvent} */ moved) => to(area, moved);
  area.onpointerup = area.onpointercancel = () => {
    area.onpointermove = null;
  };
}

/** @param {HTMLElement} bar */
const seenIn = (bar) => /** @type {HTMLElement} */ (bar.parentElement?.querySelector(".seen"));

/**
 * Move the part in sight to where the overview is pressed.
 *
 * @param {HTMLElement} bar
 * @param {PointerEvent} event
 */
function scrollTo(bar, { clientX }) {
  const seen = seenIn(bar);
  const { left, width } = bar.getBoundingClientRect();
  seen.scrollLeft = (seen.scrollWidth * (clientX - left)) / width - seen.clientWidth / 2;
}

/** Show which part of an enlarged timeline is in sight. */
function drawInSight() {
  const bar = /** @type {HTMLElement | null} */ (byId("timeline").querySelector(".overview"));
  const part = /** @type {HTMLElement | null} */ (bar?.querySelector(".in-sight"));
  if (!bar || !part) return;
  const { scrollLeft, scrollWidth, clientWidth } = seenIn(bar);
  part.style.left = `${(100 * scrollLeft) / scrollWidth}%`;
  part.style.width = `${(100 * clientWidth) / scrollWidth}%`;
}

/**
 * The overview of a timeline that scrolls; a press or a drag moves the part in sight.
 *
 * @param {Take[]} takes
 * @param {number} duration
 */
const overview = (takes, duration) =>
  html`<div
    class="overview"
    aria-hidden="true"
    ?hidden=${zoom <= 1}
    @pointerdown=${(/** @type {any} */ event) => drag(event, scrollTo)}
  >
    ${takes.map(({ start, end }) => html`<i .style=${spanning(start, end, duration)}></i>`)}
    <i class="in-sight"></i>
  </div>`;

/** @param {number} duration */
function ruler(duration) {
  const least = duration / zoom / 10; // Ten fit into what is in sight.
  const step = [0.1, 0.5, 1, 2, 5, 10, 30, 60, 120].find((each) => each >= least) ?? 300;
  const count = Math.floor(duration / step - 1 / 3) + 1;
  const ticks = Array.from({ length: count }, (_, index) => index * step);
  return html`<div class="ruler" aria-hidden="true">
    ${ticks.map(
      (second) =>
        html`<span .style=${`left: ${percent(second, duration)}`}
          >${Number(second.toFixed(1))} s</span
        >`,
    )}
  </div>`;
}

/**
 * @param {Take} take
 * @param {number} index
 * @param {number} duration
 */
function takeButton({ start, end, stroke_start: from, stroke_end: to, closed }, index, duration) {
  const chosen = state.take === index;
  const name = `Take ${index + 1}`;
  return html`<button
    type="button"
    class="take ${chosen ? "chosen" : ""} ${closed ? "" : "open"}"
    aria-pressed=${chosen}
    aria-label="${name}, ${moment(start)} to ${moment(end)}${closed ? "" : ", no closing salute"}"
    title="${name}: from ${held()} to ${held()}. The bright part is the gesture, without the hand's transit from and to it."
    .style=${spanning(start, end, duration)}
    @click=${() => update({ take: index, start: null, end: null, recognition: null })}
  >
    <span class="stroke" .style=${spanning(from - start, to - start, end - start || 1)}></span
    ><span class="take-name">${index + 1}</span>
  </button>`;
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
  [["opens", start], ...(closed ? [["closes", end]] : [])].map(
    ([kind, seconds]) =>
      html`<span
        class="salute ${kind}"
        title=${held()}
        .style=${`left: ${percent(Number(seconds), duration)}`}
        >${iconOf("salute")}</span
      >`,
  );

/**
 * Where too little was seen: no gesture is read across it.
 *
 * @param {number[]} span
 * @param {number} duration
 */
const unseen = ([start, end], duration) =>
  html`<span
    class="unseen"
    role="img"
    aria-label="Not seen, ${moment(start)} to ${moment(end)}"
    title="Too little was seen here: a salute may have been missed."
    .style=${spanning(start, end, duration)}
  ></span>`;

/** When the last frame is shown: the right edge of the timeline. */
const timeOfFrames = () => /** @type {Timeline} */ (state.timeline).time;

const lastMoment = () => timeOfFrames().at(-1) || 1;

/** @param {number} seconds */
const frameAt = (seconds) => nearestFrame(timeOfFrames(), seconds);

/** @type {Record<string, number>} how many frames a key moves a handle on */
const WAYS = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 };

/**
 * @param {"start" | "end"} which
 * @param {SelectedRange} range
 */
function handle(which, range) {
  const label = which === "start" ? "Start of the range" : "End of the range";
  const frame = frameAt(range[which]);
  /** @param {number} frame */
  const to = (frame) => {
    move(which, frame);
    seek(frame);
  };
  // The browser's default step is a share of the length, not a frame.
  const pressed = (/** @type {any} */ event) => {
    const way = WAYS[event.key];
    if (!way) return;
    event.preventDefault();
    const next = frameAt(Number(event.target.value)) + way * (event.shiftKey ? 10 : 1);
    to(Math.min(timeOfFrames().length - 1, Math.max(0, next)));
  };
  return html`<input
    type="range"
    class="handle ${which}"
    min="0"
    max=${lastMoment()}
    step="any"
    aria-label=${label}
    aria-valuetext="frame ${frame}, ${moment(range[which])}"
    title="${label}: drag, or use the arrow keys, frame by frame"
    .value=${live(String(timeOfFrames()[frame]))}
    @input=${(/** @type {any} */ { target }) => to(frameAt(Number(target.value)))}
    @keydown=${pressed}
  />`;
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
 * @param {PointerEvent & { currentTarget: any, target: any }} event
 */
function scrub(event) {
  if (event.button !== 0 || event.target.closest("button, input")) return;
  drag(event, (area, { clientX }) => {
    const { left, width } = area.getBoundingClientRect();
    seek(frameAt((lastMoment() * (clientX - left)) / width));
  });
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
  const takesAgain = html`<button type="button" class="link" @click=${back}>
    Back to ${plural(takes.length, "take")}
  </button>`;
  render(
    html`<p class="range-text">
      <span role="status">${summary(range, takes)}</span>
      ${warning ? html`<span class="salute-warning" role="alert">${warning}</span>` : nothing}
      ${state.take === null && takes.length ? takesAgain : nothing}
    </p>`,
    byId("range-text"),
  );
}

/**
 * What lies on the track: the thumbnails, the range, the takes with their salutes, the handles.
 *
 * @param {SelectedRange} range
 * @param {Take[]} takes
 * @param {number} duration
 */
function track(range, takes, duration) {
  // Takes found without a trigger have nothing held at their ends.
  const marked = held() === "gesture" ? [] : takes;
  const second = (byId("timeline").querySelector(".track")?.clientWidth ?? 0) / duration;
  const salutes = marked
    .filter(({ start }, index) => second * (start - (marked[index - 1]?.end ?? 0)) > SALUTES_ROOM)
    .flatMap((take) => saluteMarks(take, duration));
  const { unseen: holes } = /** @type {Timeline} */ (state.timeline);
  return html`<div class="track" role="group" aria-label="Takes">
    ${film}
    <div class="range" .style=${spanning(range.start, range.end, duration)}></div>
    ${salutes}${takes.map((take, index) => takeButton(take, index, duration))}${holes.map((span) =>
      unseen(span, duration),
    )}${handle("start", range)}${handle("end", range)}
  </div>`;
}

/** @param {WheelEvent} event */
function pinch(event) {
  // A pinch on a touchpad arrives as a wheel with Ctrl.
  if (!event.ctrlKey) return;
  event.preventDefault();
  zoomBy(2 ** (-event.deltaY / 200), event.clientX);
}

/** Draw the timeline of the clip on display. */
export function drawTimeline() {
  const box = byId("timeline");
  const clip = selectedClip();
  const { takes, timeline } = state;
  if (!clip || !isReadable() || !takes || !timeline) {
    box.dataset.clip = "";
    render(nothing, box);
    return;
  }
  const range = /** @type {SelectedRange} */ (selectedRange());
  const duration = lastMoment();
  // While a clip is being read, its end moves.
  const drawn = `${clip.id} ${duration}`;
  const another = box.dataset.clip !== drawn;
  if (another) {
    box.dataset.clip = drawn;
    zoom = 1;
    film = null;
  }
  drawNote(range, takes);
  const buttons = ZOOMS.map(
    ({ sign, key, text, zoom: run }) =>
      html`<button type="button" aria-label=${text} title="${text} (${key})" @click=${run}>
        ${sign}
      </button>`,
  );
  render(
    html`${overview(takes, duration)}
      <div class="seen" @scroll=${drawInSight} @wheel=${pinch}>
        <div class="zoomed" .style=${`width: ${100 * zoom}%`}>
          <div class="along" @pointerdown=${scrub}>
            ${track(range, takes, duration)}
            <div class="labelled-ranges" id="labelled-ranges"></div>
            <div class="curve-area">${guard([timeline], () => curves(timeline))}</div>
            <div class="tracks" id="tracks" hidden></div>
            <i class="now" id="now"></i>
          </div>
          ${guard([duration, zoom], () => ruler(duration))}
        </div>
      </div>
      <div class="under">${buttons}${legend(held().replace("Vulcan ", ""))}</div>`,
    box,
  );
  drawInSight();
  if (!another) return;
  zoomBy(1);
  drawNow();
}

/**
 * Enlarge the timeline about a place of the screen, or about the moment on display.
 *
 * @param {number} factor
 * @param {number} [clientX]
 */
function zoomBy(factor, clientX) {
  const clip = selectedClip();
  const [seen, zoomed, lane] = [".seen", ".zoomed", ".track"].map(
    (each) => /** @type {HTMLElement | null} */ (byId("timeline").querySelector(each)),
  );
  if (!seen || !zoomed || !lane || !clip || !state.timeline) return;
  const { left, width } = zoomed.getBoundingClientRect();
  const place = clientX ?? left + (width * (state.position?.time ?? 0)) / lastMoment();
  const share = (place - left) / width;
  const inSight = place - seen.getBoundingClientRect().left;
  zoom = Math.max(1, Math.min(MOST_ZOOM, lastMoment() / LEAST_SECONDS, zoom * factor));
  zoomed.style.width = `${100 * zoom}%`;
  seen.scrollLeft = share * zoomed.clientWidth - Math.min(seen.clientWidth, Math.max(0, inSight));
  film = filmstrip(clip, state.timeline, lane.clientWidth, lane.clientHeight);
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
