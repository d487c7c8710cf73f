// The picture of the clip: flat or as a space-time cube by viser, or drawn by the page itself.

import { browserStore } from "../core/browser-store.js";
import { figure } from "./pose-picture.js";
import { versionOf } from "../clips/clip-store.js";
import { byId } from "../core/dom.js";
import { nearestFrame } from "../clips/frame-times.js";
import { bind } from "../core/key-bindings.js";
import { follow, isReadable, selectedClip, selectedRange, state } from "../core/state.js";
import { buttonOf, html, nothing, render, svg } from "../templates.js";
import { posesOf } from "./tracks.js";
import { movingWrists, strokeOver } from "./wrist-motion.js";

/** @import { Clip, Poses, State } from "../core/types.d.ts" */

const KEY = "osg-studio.cube"; // Whether the cube was shown last.

let cube = browserStore.get(KEY) !== null;
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
  browserStore.set(KEY, cube ? "shown" : null);
  draw();
  send(!cube);
}

/** The button in the transport bar. */
export const cubeButton = () =>
  buttonOf("Space-time cube", toggleCube, {
    id: "do-cube",
    title: "Show time as depth, or the flat picture (V)",
  });

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
    text: "Switch between flat picture and space-time cube",
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

/**
 * Draw the flat picture by the page, and show the reason; `retry` tries viser again if that may
 * help.
 *
 * @param {string} reason
 * @param {(() => unknown) | null} [retry]
 */
export function drawByPage(reason, retry = null) {
  own = true;
  const again = retry ? buttonOf("Try again", retry) : nothing;
  render(
    html`<div class="flat-picture"></div>
      <p class="flat-note" role=${retry ? "alert" : "status"}>${reason}${again}</p>`,
    byId("flat"),
  );
  byId("flat").querySelector(".flat-picture").replaceChildren();
  shown = null;
  draw();
  drawFlat();
}

/** Let viser draw again. */
export function drawByViser() {
  own = false;
  draw();
}

/** @param {Clip} clip whose picture is built, unless another one is wanted by then */
async function build(clip) {
  const [poses, wanted] = [await posesOf(clip), versionOf(clip)];
  if (!poses || state.clip !== clip.id || shown?.clip === wanted) return;
  const picture = figure(() => {});
  picture.show(poses, clip);
  byId("flat").querySelector(".flat-picture")?.replaceChildren(picture.element);
  shown = { clip: wanted, poses, picture };
}

/** Draw the frame on display, where the page draws it. */
export async function drawFlat() {
  const clip = selectedClip();
  if (!own || clip?.status !== "done") return;
  if (shown?.clip !== versionOf(clip)) await build(clip);
  if (shown?.clip !== versionOf(clip)) return;
  const { poses, picture } = shown;
  const range = selectedRange()?.shown ?? [0, poses.time.at(-1) ?? 0];
  /** @type {[number, number]} */
  const frames = [nearestFrame(poses.time, range[0]), nearestFrame(poses.time, range[1])];
  const frame = Math.min(state.position?.frame ?? frames[0], poses.time.length - 1);
  picture.draw(frame, frames, movingWrists(poses, frames));
}

/**
 * Draw the stroke of the expected gesture, or of the nearest one, dashed over the shown stroke.
 *
 * @param {State} state
 */
export async function drawStroke({ why, result }) {
  const box = byId("stroke-over");
  const show = (/** @type {boolean} */ shown) => box.toggleAttribute("hidden", !shown);
  show(false);
  const clip = selectedClip();
  if (!why || result?.id !== why.id || result.clip_id !== clip?.id) return;
  if (clip.status !== "done") return; // The poses so far are not given.
  const label = result.expected ?? result.nearest;
  const alignment = why.alignments.find((each) => each.voter === "path" && each.label === label);
  const poses = alignment && (await posesOf(clip));
  if (!poses || state.why !== why) return;
  const paths = strokeOver(alignment, poses).map((path) => `M${path.filter(Boolean).join("L")}`);
  const chosen = label === result.label ? "chosen" : "nearest";
  const role = result.expected === null ? chosen : "expected";
  show(paths.length > 0);
  box.classList.toggle("is-expected", role === "expected");
  const drawn = (/** @type {string} */ kind) =>
    paths.map(
      (d) => svg`<path class=${kind} d=${kind === "begin" ? `${d.split("L")[0]}h0` : d} />`,
    );
  render(
    html`<svg
        viewBox="0 0 ${poses.frame_size.join(" ")}"
        role="img"
        aria-label="The stroke of ${label}, over the one shown"
      >
        ${["halo", "", "begin"].map(drawn)}
      </svg>
      <p class="stroke-legend"><i></i><b>${label}</b> ${role}</p>`,
    box,
  );
}

const MOST_ZOOM = 6; // times

/**
 * Enlarge the flat picture with two fingers, or with Ctrl and the wheel, as a touchpad's pinch
 * arrives; one finger then moves it.
 */
export function enlargePicture() {
  const [area, box] = [byId("lab-area"), byId("lab-box")];
  let [scale, x, y] = [1, 0, 0];
  /** @type {{ x: number, y: number, apart: number } | null} */
  let last = null; // where the fingers were

  /** Move the picture so far as it covers its box. */
  function place() {
    x = Math.min(0, Math.max(box.offsetWidth * (1 - scale), x));
    y = Math.min(0, Math.max(box.offsetHeight * (1 - scale), y));
    box.style.transform = scale > 1 ? `translate(${x}px, ${y}px) scale(${scale})` : "";
  }
  /** @type {(factor: number, clientX: number, clientY: number) => void} */
  function zoom(factor, clientX, clientY) {
    const { left, top } = box.getBoundingClientRect();
    const next = Math.min(MOST_ZOOM, Math.max(1, scale * factor));
    x -= (clientX - left) * (next / scale - 1);
    y -= (clientY - top) * (next / scale - 1);
    scale = next;
    place();
  }
  /** @param {TouchEvent} event */
  function moved(event) {
    const [one, other] = event.touches;
    if (!isFlat() || (!other && scale === 1)) return;
    event.preventDefault(); // Neither the page scrolls, nor does it grow as a whole.
    const end = other ?? one;
    const now = {
      x: (one.clientX + end.clientX) / 2,
      y: (one.clientY + end.clientY) / 2,
      apart: Math.hypot(one.clientX - end.clientX, one.clientY - end.clientY),
    };
    if (last) {
      x += now.x - last.x;
      y += now.y - last.y;
      if (last.apart) zoom(now.apart / last.apart, now.x, now.y);
      else place();
    }
    last = now;
  }
  const begin = () => {
    last = null;
  };
  box.addEventListener("touchstart", begin);
  box.addEventListener("touchend", begin);
  box.addEventListener("touchmove", moved, { passive: false });
  area.addEventListener("wheel", (/** @type {WheelEvent} */ event) => {
    if (!event.ctrlKey || !isFlat()) return;
    event.preventDefault();
    zoom(2 ** (-event.deltaY / 200), event.clientX, event.clientY);
  });
  follow(["clip"], () => {
    scale = 1;
    place();
  });
  byId("do-cube").addEventListener("click", () => {
    scale = 1;
    place();
  });
}
