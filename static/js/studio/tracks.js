// The tracks of the wrists under the timeline's curves, in the flat view as beside the cube.

import { nearestFrame } from "../clips/frame-times.js";
import { versionOf } from "../clips/clip-store.js";
import * as api from "../core/api.js";
import { browserStore } from "../core/browser-store.js";
import { readable } from "../core/format.js";
import { selectedClip, selectedRange, state } from "../core/state.js";
import { attempt } from "../core/toasts.js";
import { buttonOf, html, render } from "../templates.js";
import { linePath } from "./timeline-curves.js";
import { movingWrists, tracksOf } from "./wrist-motion.js";

/** @import { Clip, Poses } from "../core/types.d.ts" */

const KEY = "osg-studio.tracks"; // Whether the tracks were shown last.

let open = browserStore.get(KEY) !== null;

/** @type {{ clip: string, poses: Promise<Poses | null> } | null} */
let loaded = null;

/**
 * The button in the transport bar.
 *
 * @param {() => void} toggle
 */
export const tracksButton = (toggle) =>
  buttonOf("Tracks", toggle, {
    title: "Show where the moving wrists are over time (G)",
    pressed: open,
  });

/** Show the tracks, or hide them; remembered. */
export function toggleTracks() {
  open = !open;
  browserStore.set(KEY, open ? "shown" : null);
  drawTracks();
}

/** @param {Clip} clip whose poses are loaded once */
export function posesOf(clip) {
  const wanted = versionOf(clip);
  if (loaded?.clip !== wanted)
    loaded = {
      clip: wanted,
      poses: attempt("Loading the poses", () => api.clips.poses(clip.id)),
    };
  return loaded.poses;
}

/**
 * Draw one wrist's track along the clip's time.
 *
 * @param {ReturnType<typeof tracksOf>[number]} track
 * @param {number[]} time
 */
function lane({ name, x, y }, time) {
  const last = time.at(-1) || 1;
  /** @param {number} index */
  const share = (index) => ((1000 * time[index]) / last).toFixed(1);
  return html`<div class="curves track-lane">
    <svg
      viewBox="0 0 1000 30"
      preserveAspectRatio="none"
      role="img"
      aria-label="Track of the ${readable(name)}"
    >
      <path class="right" d=${linePath(x, 1, share)} />
      <path class="left" d=${linePath(y, 1, share)} />
    </svg>
    <span>${readable(name)}: x to the right, y upwards (dashed)</span>
  </div>`;
}

/** Draw the tracks of the clip on display, where they are shown. */
export async function drawTracks() {
  const box = document.getElementById("tracks");
  const clip = selectedClip();
  if (!box) return;
  box.hidden = !open;
  if (!open || clip?.status !== "done" || !state.timeline) return;
  const range = selectedRange()?.shown ?? [0, 0];
  const poses = await posesOf(clip);
  if (!poses || !box.isConnected) return;
  const wrists = movingWrists(poses, [
    nearestFrame(poses.time, range[0]),
    nearestFrame(poses.time, range[1]),
  ]);
  const none = html`<p class="dim">No wrist moves in this range.</p>`;
  render(
    wrists.length ? tracksOf(poses, wrists).map((track) => lane(track, poses.time)) : none,
    box,
  );
}
