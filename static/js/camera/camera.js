// The camera before which takes are shown, and what is wrong with it, with a way out.

import { html, nothing, render } from "../templates.js";
import { mirror } from "./mirror.js";
import { cameraLost, release, showCamera, whyNoCamera } from "./video-source.js";

/** @import { Trouble } from "./live-messages.d.ts" */

/**
 * Show what is wrong in a box; null hides it.
 *
 * @param {HTMLElement} box
 * @param {Trouble | null} trouble
 * @param {() => unknown} again Called by the button that tries again.
 */
export function drawTrouble(box, trouble, again) {
  box.hidden = !trouble;
  const words = ({ title, text } = /** @type {Trouble} */ (trouble)) =>
    html`<b>${title}</b>
      <p>${text}</p>
      <button type="button" @click=${again}>Try again</button>`;
  render(trouble ? words() : nothing, box);
}

/**
 * Start a camera, mirrored where it faces the diver; without one, its picture says why, and what
 * can be done `instead`.
 *
 * @param {{ video: HTMLVideoElement, picture: HTMLElement, box: HTMLElement }} place
 * @param {{ instead: string, again: () => unknown, lost: () => unknown, device?: string }} options
 *     `lost()` is called when it stops sending
 * @returns {Promise<boolean>} whether there is a camera now
 */
export async function startCamera({ video, picture, box }, { instead, again, lost, device = "" }) {
  drawTrouble(box, null, again);
  try {
    await showCamera(video, device, () => {
      drawTrouble(box, cameraLost(instead), again);
      lost();
    });
  } catch (error) {
    release(video);
    drawTrouble(box, whyNoCamera(error, instead), again);
    return false;
  }
  mirror(picture, video);
  return true;
}
