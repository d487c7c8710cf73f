// The playback clock of the workspace, shared by the 3D view, the timeline and the keys.

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
  const scheme = location.protocol === "https:" ? "wss" : "ws";
  const opened = new WebSocket(
    `${scheme}://${location.host}/api/v1/workspaces/${encodeURIComponent(id)}/playback`,
  );
  socket = opened;
  opened.onopen = () => {
    for (const wish of unsent.splice(0)) opened.send(JSON.stringify(wish));
  };
  opened.onmessage = ({ data }) => received(JSON.parse(data));
  // A workspace that is gone is opened anew by whoever shows something next.
  opened.onclose = () => {
    if (socket !== opened || workspace !== id) return;
    cut = true;
    setTimeout(() => {
      if (socket === opened) connect(id);
    }, RETRY);
  };
}

/** Whether the connection broke since the workspace was opened; that of the 3D view did too. */
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
 * Keep the frame that a link names, for `frameShown`.
 *
 * @param {number | null} frame
 */
export function rememberFrame(frame) {
  wantedFrame = frame;
}

/** The clip is on display: go to the frame that the link named, once. */
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
 * Pause, and go some frames on or back.
 *
 * @param {number} frames
 */
export const step = (frames) => ask({ do: "step", frames });

/**
 * Play that many times as fast as the camera saw it; backwards if negative, 0 pauses.
 *
 * @param {number} speed
 */
export const play = (speed) => ask({ do: "play", speed });

/**
 * Repeat the range on display, or play on.
 *
 * @param {boolean} on
 */
export const loop = (on) => ask({ do: "loop", on });
