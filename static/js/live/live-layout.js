// The elements of the view, before anything is seen.

import { olderClipsButton } from "../clips/older-clips.js";
import { SALUTE } from "../clips/salute-threshold.js";
import { saluteHand } from "../clips/salutes.js";
import { html } from "../templates.js";

/**
 * @param {string} id
 * @param {string} text
 * @param {string} title
 * @param {boolean} checked
 */
const check = (id, text, title, checked) =>
  html`<label class="check" title=${title}
    ><input type="checkbox" id=${id} ?checked=${checked} /><span id="${id}-text"
      >${text}</span
    ></label
  >`;

const picture = () =>
  html`<div class="camera-picture" id="live-picture">
    <video id="live-video" .muted=${true} playsinline aria-label="What the camera sees"></video>
    <div class="camera-idle" id="live-idle">${saluteHand()}No source is running</div>
    <p class="live-count" id="live-count" role="timer" aria-live="assertive" hidden></p>
    <div class="camera-problem" id="live-problem" role="alert" hidden></div>
  </div>`;

const controls = () =>
  html`<div class="live-controls">
    <div class="segments" role="group" aria-label="Source">
      <button type="button" id="live-from-camera" aria-pressed="false">Camera</button
      ><button type="button" id="live-from-clip" aria-pressed="false">Clip</button>
    </div>
    <select id="live-cameras" aria-label="Camera" hidden></select>
    <select id="live-clips" aria-label="Clip" hidden></select>
    ${olderClipsButton()}${check(
      "live-every",
      "Every frame",
      "Processes every frame, also when this machine is slower than the clip",
      false,
    )}${check(
      "live-autostop",
      "Stop after the closing salute",
      "Ends a recording when a take ends, without a click",
      true,
    )}
    <span class="spacer"></span>
    <button
      type="button"
      id="live-record"
      data-writes
      title="Record a clip, after a countdown (R)"
    ></button>
    <button
      type="button"
      id="live-start"
      class="primary"
      title="Start or stop watching (Space)"
    ></button>
  </div>`;

/** What the view holds. */
export const panel = () =>
  html`<section class="live-stage" aria-label="Live picture">
      <h1>Live recognition</h1>
      ${picture()}
      <div class="live-state">
        <ol class="live-steps" id="live-steps">
          <li id="live-step-salute">Salute</li>
          <li id="live-step-gesture">Gesture</li>
          <li id="live-step-closing">Salute</li>
        </ol>
        <p id="live-instruction" role="status"></p>
        <label class="live-salute" id="live-meter"
          ><span id="live-held">Salute</span
          ><meter id="live-salute" min="0" max="1" low=${SALUTE} value="0"></meter
        ></label>
      </div>
      ${controls()}
    </section>
    <aside class="live-side" aria-label="Recognised live">
      <div id="live-result" aria-live="polite"></div>
      <p class="dim" id="live-language"></p>
      <div class="live-head">
        <h2>Recognised</h2>
        <button type="button" class="link" id="live-clear" hidden>Clear</button>
      </div>
      <ol class="live-recognised" id="live-recognised" aria-label="Recognised, newest first"></ol>
      <p class="live-slow" id="live-slow" hidden>
        Too few frames per second to recognise gestures. Close other programs, or record a clip: all
        of its frames are used.
      </p>
      <dl class="live-speed" id="live-speed"></dl>
    </aside>`;
