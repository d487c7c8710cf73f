// Draws the status of the live view; its words come from camera/take-steps.js.

import { howTo, isSlow, situation } from "../camera/take-steps.js";
import { SALUTE } from "../clips/salute-threshold.js";
import { html, ifDefined } from "../templates.js";

/** @import { Seen } from "../camera/live-messages.d.ts" */

/**
 * The diver's step between what begins and ends a take; without a held trigger, no steps. Null
 * while no source is watched.
 *
 * @param {Seen | null} answer
 * @param {string} kind of the trigger
 */
export function stepsOf(answer, kind) {
  const [step, text] = answer ? situation(answer, kind) : ["", howTo(kind)];
  const held = kind === "salute" ? "Salute" : "Pose";
  const unheld = kind === "gesture" || kind === "none";
  const item = (/** @type {string} */ name, /** @type {string} */ words) =>
    html`<li id="live-step-${name}" aria-current=${ifDefined(name === step ? "step" : undefined)}>
      ${words}
    </li>`;
  return html`<div class="live-state">
    <ol class="live-steps" id="live-steps" ?hidden=${unheld}>
      ${item("salute", held)}${item("gesture", "Gesture")}${item("closing", held)}
    </ol>
    <p id="live-instruction" role="status">${text}</p>
    <label class="live-salute" id="live-meter" ?hidden=${unheld}
      ><span>${held}</span
      ><meter min="0" max="1" low=${SALUTE} .value=${answer?.salute ?? 0}></meter
    ></label>
  </div>`;
}

/**
 * Frames per second, and the seconds from the camera to the answer.
 *
 * @param {Seen | null} answer
 * @param {number} seconds
 * @param {boolean} unhurried whether every frame is looked at, however long it takes
 */
export function speedOf(answer, seconds, unhurried) {
  /** @type {[string, string][]} */
  const rows =
    answer === null
      ? []
      : [
          ["Frames a second", answer.frames_per_second.toFixed(1)],
          ["Latency", `${Math.round(1000 * seconds)} ms`],
          ["of which the models", `${Math.round(1000 * answer.seconds)} ms`],
        ];
  return html`<p class="live-slow" ?hidden=${!answer || unhurried || !isSlow(answer)}>
      Too few frames per second to recognise gestures. Close other programs, or record a clip: all
      of its frames are used.
    </p>
    <dl class="live-speed">
      ${rows.map(
        ([name, value]) =>
          html`<div>
            <dt>${name}</dt>
            <dd>${value}</dd>
          </div>`,
      )}
    </dl>`;
}
