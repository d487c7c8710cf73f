// The status of the live view in words: the salute, the take, the frame rate.

import { howTo, isSlow, situation } from "../camera/take-steps.js";
import { byId, h } from "../core/dom.js";
import { endName } from "../clips/salutes.js";
import { state as page } from "../core/state.js";

/** @import { Seen } from "../camera/live-messages.d.ts" */

const kindOf = () => page.gestures?.trigger?.kind ?? "salute";

/**
 * Show what begins and ends a take with the language's trigger; without a held trigger, no steps.
 */
export function nameTrigger() {
  const kind = kindOf();
  const held = kind === "salute" ? "Salute" : "Pose";
  for (const id of ["live-step-salute", "live-step-closing", "live-held"])
    byId(id).textContent = held;
  byId("live-autostop-text").textContent = `Stop after the closing ${endName(page.gestures)}`;
  byId("live-steps").hidden = byId("live-meter").hidden = kind === "gesture" || kind === "none";
}

/**
 * Show the diver's step between the salutes; null while no source is watched.
 *
 * @param {Seen | null} answer
 */
export function drawState(answer) {
  const [step, text] = answer ? situation(answer, kindOf()) : ["", howTo(kindOf())];
  const words = byId("live-instruction");
  if (words.textContent !== text) words.textContent = text;
  for (const each of byId("live-steps").children) {
    if (each.id === `live-step-${step}`) each.setAttribute("aria-current", "step");
    else each.removeAttribute("aria-current");
  }
  byId("live-salute").value = answer?.salute ?? 0;
}

/**
 * Show frames per second, and the seconds from the camera to the answer.
 *
 * @param {Seen | null} answer
 * @param {number} seconds
 */
export function drawSpeed(answer, seconds) {
  const rows =
    answer === null
      ? []
      : [
          ["Frames a second", answer.frames_per_second.toFixed(1)],
          ["Latency", `${Math.round(1000 * seconds)} ms`],
          ["of which the models", `${Math.round(1000 * answer.seconds)} ms`],
        ];
  const unhurried = page.source === "clip" && byId("live-every").checked;
  byId("live-slow").hidden = !answer || unhurried || !isSlow(answer);
  byId("live-speed").replaceChildren(
    ...rows.map(([name, value]) => h("div", {}, h("dt", {}, name), h("dd", {}, value))),
  );
}
