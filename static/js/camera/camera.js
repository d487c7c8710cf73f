// The camera before which takes are shown, or a clip played as if live: its picture, what the
// server sees in it, and what is wrong with it, with a way out.

import { h } from "../core/dom.js";
import { html, nothing, optionsOf } from "../templates.js";
import { isMirrored } from "./mirror.js";
import { drawSeen, overlay } from "./pose-overlay.js";
import { countDown, record } from "./recording.js";
import { takeEnd } from "./take-end.js";
import {
  cameraLost,
  cameraPossible,
  listCameras,
  release,
  showCamera,
  showClip,
  whyNoCamera,
} from "./video-source.js";
import { watch } from "./watching.js";

/** @import { Handlers, Trouble } from "./live-messages.d.ts" */

/**
 * What is drawn of a camera: `count` are the seconds before a recording, `share` is how much of its
 * time is over.
 *
 * @typedef {{ on: boolean, busy: boolean, recording: boolean, mirrored: boolean, trouble: Trouble | null, count: number | null, share: number | null, cameras: [string, string][], device: string, drawing: SVGSVGElement | null }} Shown
 */

/**
 * What is wrong, with a button that tries again.
 *
 * @param {Trouble} trouble
 * @param {() => unknown} again
 */
export const tellTrouble = ({ title, text }, again) =>
  html`<b>${title}</b>
    <p>${text}</p>
    <button type="button" @click=${again}>Try again</button>`;

/**
 * Make a camera. `draw()` draws its view anew; `instead` is what can be done without a camera;
 * `start()` tries once more, or another one; `stop()` is called when it is lost.
 *
 * @param {{ instead: string, draw: () => void, start: () => unknown, stop: () => void }} view
 */
export function makeCamera({ instead, draw, start, stop }) {
  const video = h("video", {
    muted: true,
    playsInline: true,
    "aria-label": "What the camera sees",
  });
  /** @type {Shown} */
  const shown = {
    on: false,
    busy: false,
    recording: false,
    mirrored: true,
    trouble: null,
    count: null,
    share: null,
    cameras: [],
    device: "",
    drawing: null,
  };
  let over = () => {};
  const end = takeEnd(() => over());
  /** @type {ReturnType<typeof watch> | null} */
  let watching = null;

  /** @param {Partial<Shown>} change */
  function put(change) {
    Object.assign(shown, change);
    draw();
  }

  const list = async () => cameraPossible() && put(await listCameras(video, shown.device));

  const lost = () => {
    put({ trouble: cameraLost(instead) });
    stop();
  };

  /**
   * Show the chosen camera, or a clip by its address; whether there is a picture now.
   *
   * @param {string | null} [clip]
   */
  async function show(clip = null) {
    put({ busy: true, trouble: null });
    try {
      await (clip ? showClip(video, clip) : showCamera(video, shown.device, lost));
      put({ on: true, busy: false, mirrored: isMirrored(video.srcObject) });
    } catch (error) {
      release(video);
      const trouble = clip
        ? { title: "The clip cannot be played", text: error.message }
        : whyNoCamera(error, instead);
      put({ busy: false, trouble });
    }
    if (!clip) list(); // The chosen one may be gone.
    return shown.on;
  }

  /** Let nobody look any more. */
  function unwatch() {
    watching?.stop();
    end.reset();
    watching = null;
  }

  addEventListener("pagehide", stop);
  navigator.mediaDevices?.addEventListener("devicechange", list);
  return {
    video,
    shown,
    put,
    show,
    unwatch,
    /** Count the take that was shown as over. */
    reset: end.reset,
    /**
     * Let the server watch, with handlers for its answers; `taken()` is called when a take is over.
     *
     * @param {Partial<Handlers> & { kind: () => string, taken: () => unknown }} handlers
     * @param {Parameters<typeof watch>[2]} [place]
     */
    watch({ kind, taken, ...handlers }, place) {
      over = taken;
      const opened = watch(
        video,
        {
          listening: () => {},
          ended: () => {},
          ...handlers,
          seen: (answer, seconds) => {
            if (shown.drawing) drawSeen(shown.drawing, answer);
            end.seen(answer);
            handlers.seen?.(answer, seconds);
          },
          recognized: (result) => {
            end.recognized(result, kind());
            handlers.recognized?.(result);
          },
        },
        place,
      );
      watching = opened;
      const goesOn = () => watching === opened;
      return { ...opened, goesOn, stop: () => goesOn() && unwatch() };
    },
    /** Whether there is a picture, or something to say of it. */
    isThere: () => shown.on || shown.busy || shown.trouble !== null,
    /** Lay the pose that the server sees over the picture. */
    overlay: () => put({ drawing: overlay(video) }),
    /**
     * Recognise with this language from now on.
     *
     * @param {string | null} language
     */
    listen: (language) => watching?.listen(language),
    /**
     * Count down; whether to the end.
     *
     * @param {number} from
     * @param {AbortSignal} signal
     * @param {(left: number | null) => void} [tick]
     */
    countDown: (from, signal, tick = () => {}) =>
      countDown(
        from,
        (count) => {
          put({ count });
          tick(count);
        },
        signal,
      ),
    /** Begin a recording; null where there is no camera. */
    record: () => (video.srcObject instanceof MediaStream ? record(video.srcObject) : null),
    /** Turn it off. */
    off() {
      unwatch();
      release(video);
      put({ on: false, recording: false, drawing: null });
    },
    /**
     * Its picture; `idle` is shown while it is off.
     *
     * @param {{ idle?: unknown, hidden?: boolean }} [more]
     */
    picture: ({ idle = nothing, hidden = false } = {}) => {
      const { on, recording, mirrored, trouble, count, share, drawing } = shown;
      return html`<div
        class="camera-picture ${mirrored ? "mirrored" : ""} ${recording ? "recording" : ""}"
        ?hidden=${hidden}
      >
        ${video}${drawing}
        <div class="camera-idle" ?hidden=${on || idle === nothing}>${idle}</div>
        <p
          class="camera-count"
          role="timer"
          aria-live="assertive"
          ?hidden=${count === null}
          .textContent=${String(count ?? "")}
        ></p>
        <progress
          aria-label="Recording"
          max="1"
          .value=${share ?? 0}
          ?hidden=${share === null}
        ></progress>
        <div class="camera-problem" role="alert" ?hidden=${!trouble}>
          ${trouble ? tellTrouble(trouble, start) : nothing}
        </div>
      </div>`;
    },
    /** The choice among several cameras. */
    choice: () =>
      html`<select
        aria-label="Camera"
        ?hidden=${shown.cameras.length < 2}
        @change=${(/** @type {any} */ { target }) => {
          shown.device = target.value;
          start();
        }}
      >
        ${optionsOf(shown.cameras, shown.device)}
      </select>`,
  };
}
