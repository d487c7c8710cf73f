// The playback clock of the workspace, shared by the 3D view, the timeline and the keys.

import { openSocket } from "../core/server.js";
import { state, update } from "../core/state.js";

/** @import { Position } from "../core/types.d.ts" */

/** @typedef {{ do: "seek", frame: number } | { do: "step", frames: number } | { do: "play", speed: number } | { do: "loop", on: boolean }} Wish */

const RETRY = 1000; // ms

/** @type {WebSocket | null} */
let socket = null;
/** @type {string | null} */
let workspace = null;
let cut = false; // whether the connection to this workspace's clock has broken
/** @type {Wish[]} */
let unsent = []; // commands from before the connection opened
/** @type {number | null} */
let wantedFrame = null; // from the URL, until the clip is shown
let goesOn = false; // whether the next view leaves the clock where it is

/**
 * Follow the clock of a workspace, and of another one when that one is gone.
 *
 * @param {string} id
 */
export function followClock(id) {
  workspace = id;
  cut = false;
  unsent = [];
  socket?.close();
  connect(id);
}

/** @param {string} id */
function connect(id) {
  const opened = openSocket(`/workspaces/${encodeURIComponent(id)}/playback`);
  socket = opened;
  opened.onopen = () => {
    for (const wish of unsent.splice(0)) opened.send(JSON.stringify(wish));
  };
  opened.onmessage = ({ data }) => received(JSON.parse(data));
  // A closed workspace is opened again when something is shown next.
  opened.onclose = () => {
    if (socket !== opened || workspace !== id) return;
    cut = true;
    setTimeout(() => {
      if (socket === opened) connect(id);
    }, RETRY);
  };
}

/** Whether the connection broke since the workspace was opened; the 3D view's broke with it. */
export const wasCut = () => cut;

/** @param {Position} position */
function received(position) {
  const rests = !position.playing && wantedFrame === null && state.takes !== null;
  update(rests ? { position, frame: position.frame } : { position });
}

/** @param {Wish} wish */
function ask(wish) {
  if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(wish));
  else unsent.push(wish);
}

/**
 * Keep the frame number from a link, for `frameShown`.
 *
 * @param {number | null} frame
 */
export function rememberFrame(frame) {
  wantedFrame = frame;
}

/** Let the clock go on where it is when the next view is shown. */
export function keepFrame() {
  goesOn = true;
}

/** Whether the view that is shown now leaves the clock where it is. */
export function keepsFrame() {
  const kept = goesOn;
  goesOn = false;
  return kept;
}

/** Called when the clip is on display: go to the frame from the link, once. */
export function frameShown() {
  if (wantedFrame !== null) seek(wantedFrame);
  wantedFrame = null;
}

/**
 * Show a frame of the clip, counted from 0.
 *
 * @param {number} frame
 */
export const seek = (frame) => ask({ do: "seek", frame: Math.max(0, Math.round(frame)) });

/**
 * Pause, and step some frames forward or back.
 *
 * @param {number} frames
 */
export const step = (frames) => ask({ do: "step", frames });

/**
 * Play at a multiple of the recorded speed; backwards if negative, 0 pauses.
 *
 * @param {number} speed
 */
export const play = (speed) => ask({ do: "play", speed });

/**
 * Set whether the range on display is repeated.
 *
 * @param {boolean} on
 */
export const loop = (on) => ask({ do: "loop", on });
