// The playback controls under the timeline, and their keys.

import { byId } from "../core/dom.js";
import { moment } from "../core/format.js";
import { bind } from "../core/key-bindings.js";
import { isReadable, state, update } from "../core/state.js";
import { buttonOf, html, iconOf, ifDefined, render } from "../templates.js";
import { loop, play, step } from "./playback.js";
import { cubeButton, followChoice } from "./clip-picture.js";
import { setEnd, setStart, ZOOMS } from "./timeline.js";
import { toggleTracks, tracksButton } from "./tracks.js";
import { showFlat } from "./workspace.js";

/** @import { Binding, State } from "../core/types.d.ts" */

const SPEEDS = [0.25, 0.5, 1, 2];
const FASTEST = 16;
const GROUP = "Playback";

let speed = 1; // as chosen

const toggle = () => play(state.position?.playing ? 0 : speed);

/**
 * Handle J and L: reverse at normal speed, or double the speed in the same direction.
 *
 * @param {1 | -1} direction
 */
function shuttle(direction) {
  const { playing, speed: now } = state.position ?? { playing: false, speed: 1 };
  const same = playing && Math.sign(now) === direction;
  play(direction * (same ? Math.min(FASTEST, 2 * Math.abs(now)) : 1));
}

/**
 * Choose the take after the one on display, or before it.
 *
 * @param {1 | -1} by
 */
function neighbour(by) {
  const { takes, take } = state;
  if (!takes?.length) return;
  const next = take === null ? (by > 0 ? 0 : takes.length - 1) : take + by;
  if (takes[next]) update({ take: next, start: null, end: null, recognition: null });
}

/**
 * @param {string} name
 * @param {string} label
 * @param {string} keys
 * @param {() => unknown} run
 * @param {{ icon?: string, pressed?: boolean }} [more]
 */
const button = (name, label, keys, run, { icon = name, pressed } = {}) =>
  html`<button
    type="button"
    class="quiet icon"
    id="do-${name}"
    aria-label=${label}
    aria-pressed=${ifDefined(pressed)}
    title=${keys ? `${label} (${keys})` : label}
    @click=${run}
  >
    ${iconOf(icon)}
  </button>`;

/** Draw the bar, and bind its keys. */
export function bindTransport() {
  drawTransport(state);
  followChoice({ changed: showFlat, play: toggle });
  const when = () => isReadable() && state.position !== null && !byId("view-studio").hidden;
  /**
   * @param {string[]} names
   * @param {string} text
   * @param {Binding["run"]} run
   */
  const keys = (names, text, run) => bind({ keys: names, text, group: GROUP, run, when });
  keys(["Space"], "Play or pause", toggle);
  keys([","], "One frame back", () => step(-1));
  keys(["."], "One frame on", () => step(1));
  keys(["Shift+,"], "Ten frames back", () => step(-10));
  keys(["Shift+."], "Ten frames on", () => step(10));
  keys(["J"], "Play backwards; again: twice as fast", () => shuttle(-1));
  keys(["K"], "Pause", () => play(0));
  keys(["L"], "Play; again: twice as fast", () => shuttle(1));
  keys(["T"], "Next take", () => neighbour(1));
  keys(["Shift+T"], "Take before", () => neighbour(-1));
  keys(["G"], "Tracks of the wrists", switchTracks);
  for (const { key, text, zoom } of ZOOMS) keys([key, `Shift+${key}`], text, zoom);
  keys(["["], "Let the range start here", setStart);
  keys(["]"], "Let the range end here", setEnd);
}

const NOWHERE = {
  playing: false,
  speed: 1,
  loop: false,
  frame: 0,
  frames: 0,
  time: 0,
  picture: null,
};

const switchTracks = () => {
  toggleTracks();
  drawTransport(state);
};

/**
 * Draw the bar, and where the clock stands.
 *
 * @param {State} state
 */
export function drawTransport({ position }) {
  const bar = byId("transport");
  bar.hidden = !position || !isReadable();
  const { playing, frame, frames, time, picture, loop: looped, speed: now } = position ?? NOWHERE;
  // If the picture on display is another frame's, its number is shown too.
  const other = !playing && picture !== null && picture !== frame;
  const rate = playing && Math.abs(now) !== 1 ? `, ${now}\u00d7` : "";
  const clock = html`<b>${moment(time)}</b> frame ${frame} of ${frames}${rate}`;
  const choose = (/** @type {any} */ { target }) => {
    speed = Number(target.value);
    if (state.position?.playing) play(speed);
  };
  render(
    html`<div class="transport-buttons">
        ${button("back", "One frame back", ",", () => step(-1))}
        ${button("play", playing ? "Pause" : "Play", "Space", toggle, {
          icon: playing ? "pause" : "play",
        })}
        ${button("forth", "One frame on", ".", () => step(1))}
      </div>
      <p class="clock" id="clock">${clock}</p>
      <small
        class="dim num"
        title="Not every picture of a clip this long is kept. Choose a take or a shorter range to see all of them."
        >${other ? `picture of frame ${picture}` : ""}</small
      >
      <label class="visually-hidden" for="speed">Speed</label>
      <select id="speed" title="Speed" @change=${choose}>
        ${SPEEDS.map((each) => html`<option value=${each} ?selected=${each === 1}>${each}×</option>`)}
      </select>
      ${button("loop", "Repeat the range", "", () => loop(!looped), { pressed: looped })}
      <span class="joined edges"
        >${buttonOf("Start here", setStart, { title: "Let the range start here ([)" })}${buttonOf(
          "End here",
          setEnd,
          { title: "Let the range end here (])" },
        )}</span
      >
      ${tracksButton(switchTracks)}${cubeButton()}`,
    bar,
  );
}
