// The picture of the clip: flat or as a space-time cube by viser, or drawn by the page itself.

import { figure } from "./pose-picture.js";
import { versionOf } from "../clips/clip-store.js";
import * as api from "../core/api.js";
import { byId, h } from "../core/dom.js";
import { nearestFrame } from "../clips/frame-times.js";
import { bind } from "../core/key-bindings.js";
import { isReadable, selectedClip, selectedRange, state } from "../core/state.js";
import { attempt } from "../core/toasts.js";
import { movingWrists } from "./wrist-motion.js";

/** @import { Clip, Poses } from "../core/types.d.ts" */

const KEY = "osg-studio.cube"; // localStorage: whether the cube was shown last.

let cube = localStorage.getItem(KEY) !== null;
let own = false; // whether the page draws the picture itself
/** @type {(flat: boolean) => void} */
let send = () => {};

export const isFlat = () => own || !cube;

/** Show the chosen view, and the button that changes it. */
function draw() {
  byId("lab-area").classList.toggle("is-flat", isFlat());
  byId("lab").hidden = own;
  byId("flat").hidden = !own;
  const button = document.getElementById("do-cube");
  if (!button) return;
  button.hidden = own;
  button.setAttribute("aria-pressed", String(!isFlat()));
}

/** Change between the flat picture and the space-time cube. */
export function toggleCube() {
  if (own) return;
  cube = !cube;
  if (cube) localStorage.setItem(KEY, "shown");
  else localStorage.removeItem(KEY);
  draw();
  send(!cube);
}

/** The button in the transport bar. */
export const cubeButton = () =>
  h(
    "button",
    {
      type: "button",
      id: "do-cube",
      title: "Show time as depth, or the flat picture (V)",
      onclick: toggleCube,
    },
    "Space-time cube",
  );

/**
 * Bind the choice: `changed(flat)` is called when it changes, `play()` by a click on the flat
 * picture.
 *
 * @param {{ changed: (flat: boolean) => void, play: () => void }} options
 */
export function followChoice({ changed, play }) {
  send = changed;
  byId("lab-box").onclick = () => {
    if (isFlat()) play();
  };
  bind({
    keys: ["V"],
    text: "Space-time cube, or the flat picture",
    group: "Playback",
    run: toggleCube,
    when: () => isReadable() && !byId("view-studio").hidden,
  });
  draw();
}

/** Give the box of the picture the clip's aspect ratio. */
export function drawRatio() {
  const clip = selectedClip();
  if (clip?.width && clip.height)
    byId("lab-area").style.setProperty("--ratio", String(clip.width / clip.height));
}

/** @type {{ clip: string, poses: Poses, picture: ReturnType<typeof figure> } | null} */
let shown = null;
/** @type {string | null} */
let loading = null;

/**
 * Draw the flat picture by the page, and show the reason; `retry` tries viser again if that may
 * help.
 *
 * @param {string} reason
 * @param {(() => unknown) | null} [retry]
 */
export function drawByPage(reason, retry = null) {
  own = true;
  byId("flat").replaceChildren(
    h("div", { className: "flat-picture" }),
    h(
      "p",
      { className: "flat-note", role: retry ? "alert" : "status" },
      reason,
      retry ? h("button", { type: "button", onclick: retry }, "Try again") : null,
    ),
  );
  shown = loading = null;
  draw();
  drawFlat();
}

/** Let viser draw again. */
export function drawByViser() {
  own = false;
  draw();
}

/**
 * Load the poses of a clip and build its picture; null when another clip is wanted by now.
 *
 * @param {Clip} clip
 */
async function load(clip) {
  const wanted = versionOf(clip);
  if (loading === wanted) return null;
  loading = wanted;
  const poses = await attempt("Loading the poses", () => api.clips.poses(clip.id));
  if (!poses || loading !== wanted) return null;
  const picture = figure(() => {});
  picture.show(poses, clip);
  byId("flat").querySelector(".flat-picture")?.replaceChildren(picture.element);
  return { clip: wanted, poses, picture };
}

/** Draw the frame on display, where the page draws it. */
export async function drawFlat() {
  const clip = selectedClip();
  if (!own || clip?.status !== "done") return;
  if (shown?.clip !== versionOf(clip)) {
    const loaded = await load(clip);
    if (!loaded) return;
    shown = loaded;
  }
  const { poses, picture } = shown;
  const range = selectedRange()?.shown ?? [0, poses.time.at(-1) ?? 0];
  /** @type {[number, number]} */
  const frames = [nearestFrame(poses.time, range[0]), nearestFrame(poses.time, range[1])];
  const frame = Math.min(state.position?.frame ?? frames[0], poses.time.length - 1);
  picture.draw(frame, frames, movingWrists(poses, frames));
}
