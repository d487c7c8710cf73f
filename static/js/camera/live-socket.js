// The WebSocket of the live view: sends frames, receives poses and recognitions.

import { openSocket } from "../core/server.js";

/** @import { Handlers, Seen } from "./live-messages.d.ts" */

const PER_LOOK = 3; // frames sent for each one processed: the server takes the newest.
const MOST_UNSENT = 500_000; // bytes: on a slow network frames are left out before they are sent.

/** @type {Record<number, string>} */
const CLOSED = {
  1006: "The server did not answer. Is it still running?",
  1012: "The server was stopped or restarted.",
  4408: "Nothing came from the camera for a minute.",
};

/**
 * Open the live session.
 *
 * @param {Handlers} handlers A function for each kind of message, and for the end.
 * @param {{ path?: string, protocols?: string[] }} [place]
 */
export function openLink(handlers, { path = "/live", protocols = [] } = {}) {
  const socket = openSocket(path, protocols);
  /** @type {Map<number, number>} */
  const captured = new Map(); // Capture time by the page's clock, by frame under way.
  /** @type {((value?: unknown) => void)[]} */
  const waiting = []; // for an answer
  /** @type {object | null} */
  let wanted = null;
  let closing = false;
  let sent = -Infinity; // s, by the page's clock
  let rate = 0; // frames that the server processes per second

  /** @param {Seen} answer */
  function seen(answer) {
    const at = captured.get(answer.time);
    rate = answer.frames_per_second;
    for (const time of captured.keys()) if (time <= answer.time) captured.delete(time);
    handlers.seen(answer, performance.now() / 1000 - (at ?? performance.now() / 1000));
    for (const resolve of waiting.splice(0)) resolve();
  }

  const ask = () => {
    if (socket.readyState === WebSocket.OPEN && wanted) socket.send(JSON.stringify(wanted));
  };

  socket.onopen = ask;
  socket.onmessage = ({ data }) => {
    const answer = JSON.parse(data);
    if (answer.kind === "seen") seen(answer);
    else if (answer.kind === "recognized") handlers.recognized(answer);
    else if (answer.kind === "listening") handlers.listening(answer);
  };
  socket.onclose = ({ code, reason }) => {
    for (const resolve of waiting.splice(0)) resolve();
    if (!closing)
      handlers.ended(
        reason
          ? `${reason[0].toUpperCase()}${reason.slice(1)}`
          : (CLOSED[code] ?? `The connection was closed (${code}).`),
      );
  };

  return {
    /** Whether another frame may be sent now. */
    ready() {
      if (socket.readyState !== WebSocket.OPEN || socket.bufferedAmount > MOST_UNSENT) return false;
      return !captured.size || performance.now() / 1000 - sent > 1 / (PER_LOOK * rate);
    },
    /**
     * Recognise with this language from now on.
     *
     * @param {string | null} language
     */
    listen(language) {
      wanted = { do: "listen", language_id: language };
      ask();
    },
    /**
     * Send the frame at `time` seconds, captured at `at` in seconds of the page's clock.
     *
     * @param {number} time
     * @param {number} at
     * @param {Blob} picture
     */
    async send(time, at, picture) {
      captured.set(time, at);
      sent = performance.now() / 1000;
      const bytes = new Uint8Array(8 + picture.size);
      new DataView(bytes.buffer).setFloat64(0, time, true);
      bytes.set(new Uint8Array(await picture.arrayBuffer()), 8);
      if (socket.readyState === WebSocket.OPEN) socket.send(bytes);
    },
    /** Resolves with the next answer, or the end. */
    answered: () =>
      socket.readyState > WebSocket.OPEN
        ? Promise.resolve()
        : new Promise((resolve) => {
            waiting.push(resolve);
          }),
    opened: new Promise((resolve) => {
      socket.addEventListener("open", resolve);
      socket.addEventListener("close", resolve);
    }),
    close() {
      closing = true;
      socket.close(1000);
    },
  };
}
