// The playback controls under the timeline, and their keys.

import { byId } from "../core/dom.js";
import { moment } from "../core/format.js";
import { bind } from "../core/key-bindings.js";
import { isReadable, state, update } from "../core/state.js";
import { buttonOf, elementOf, html, iconOf, render } from "../templates.js";
import { loop, play, step } from "./playback.js";
import { cubeButton, followChoice } from "./clip-picture.js";
import { setEnd, setStart, ZOOMS } from "./timeline.js";
import { toggleTracks, tracksButton } from "./tracks.js";
import { showFlat } from "./workspace.js";

/** @import { Binding, State } from "../core/types.d.ts" */

const SPEEDS = [0.25, 0.5, 1, 2];
const FASTEST = 16;
const GROUP = "Playback";

const speed = () => Number(byId("speed").value);

const toggle = () => play(state.position?.playing ? 0 : speed());

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
 */
const button = (name, label, keys, run) =>
  html`<button
    type="button"
    class="quiet icon"
    id="do-${name}"
    aria-label=${label}
    title=${keys ? `${label} (${keys})` : label}
    @click=${run}
  >
    ${iconOf(name)}
  </button>`;

/** Build the bar, and bind its keys. */
export function buildTransport() {
  const changed = () => {
    if (state.position?.playing) play(speed());
  };
  render(
    html`<div class="transport-buttons">
        ${button("back", "One frame back", ",", () => step(-1))}
        ${button("play", "Play", "Space", toggle)}
        ${button("forth", "One frame on", ".", () => step(1))}
      </div>
      <p class="clock" id="clock"></p>
      <small
        class="dim num"
        id="picture-of"
        title="Not every picture of a clip this long is kept. Choose a take or a shorter range to see all of them."
      ></small>
      <label class="visually-hidden" for="speed">Speed</label>
      <select id="speed" title="Speed" @change=${changed}>
        ${SPEEDS.map((each) => html`<option value=${each} ?selected=${each === 1}>${each}×</option>`)}
      </select>
      ${button("loop", "Repeat the range", "", () => loop(!state.position?.loop))}
      <span class="joined edges"
        >${buttonOf("Start here", setStart, { title: "Let the range start here ([)" })}${buttonOf(
          "End here",
          setEnd,
          { title: "Let the range end here (])" },
        )}</span
      >
      ${tracksButton()}${cubeButton()}`,
    byId("transport"),
  );
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
  keys(["G"], "Tracks of the wrists", toggleTracks);
  for (const { key, text, zoom } of ZOOMS) keys([key, `Shift+${key}`], text, zoom);
  keys(["["], "Let the range start here", setStart);
  keys(["]"], "Let the range end here", setEnd);
}

/**
 * Show where the clock stands.
 *
 * @param {State} state
 */
export function drawTransport({ position }) {
  const bar = byId("transport");
  bar.hidden = !position || !isReadable();
  if (bar.hidden || !position) return;
  const { playing, frame, frames, time } = position;
  const toggles = byId("do-play");
  const label = playing ? "Pause" : "Play";
  if (toggles.getAttribute("aria-label") !== label) {
    toggles.replaceChildren(elementOf(iconOf(playing ? "pause" : "play")));
    toggles.setAttribute("aria-label", label);
    toggles.title = `${label} (Space)`;
  }
  // If the picture on display is another frame's, its number is shown too.
  const other = !playing && position.picture !== null && position.picture !== frame;
  byId("picture-of").textContent = other ? `picture of frame ${position.picture}` : "";
  byId("do-loop").setAttribute("aria-pressed", String(position.loop));
  const rate = playing && Math.abs(position.speed) !== 1 ? `, ${position.speed}\u00d7` : "";
  render(html`<b>${moment(time)}</b> frame ${frame} of ${frames}${rate}`, byId("clock"));
}
