// The status of the live view in words: the salute, the take, the frame rate.

import { byId, h } from "../core/dom.js";
import { SALUTE } from "../clips/salute-threshold.js";
import { endName } from "../clips/salutes.js";
import { state as page } from "../core/state.js";

/** @import { Seen } from "./live-messages.d.ts" */

const FEW = 6; // frames a second: below, a gesture of a second has at most five points.

const HOW_TO = {
  salute: "Hold a Vulcan salute, show the gesture, salute again.",
  pose: "Hold the pose of the arms, show the gesture, hold the closing pose.",
  gesture: "Show the gesture that begins a take, then gestures, then the one that ends it.",
  none: "Show a gesture, with rest before and after it.",
};

/** @type {[string, string]} */
const NOBODY = ["", "Nobody is in the picture."];

/**
 * The same where a pose of the arms begins and ends a take.
 *
 * @param {Pick<Seen, "pose" | "salute" | "held" | "state">} message
 */
function posed({ pose, salute, held, state }) {
  if (state === "done") return ["closing", "Gesture taken. Lower the arms."];
  if (state === "recording" && held) return ["salute", "Pose held. Leave it and show the gesture."];
  const seen = salute > SALUTE;
  if (state === "recording")
    return seen
      ? ["closing", "Closing pose seen. Hold it."]
      : ["gesture", "Show the gesture, then hold the closing pose."];
  if (seen) return ["salute", "Pose seen. Hold it."];
  return pose ? ["", "Waiting for the pose of the arms."] : NOBODY;
}

/**
 * The diver's step and the next instruction, from a message of the server.
 *
 * @param {Seen} message
 */
function situation({ pose, salute, held, state }) {
  const trigger = page.gestures?.trigger;
  if (trigger && trigger.kind !== "pose") return pose ? ["gesture", "Show a gesture."] : NOBODY;
  if (trigger) return posed({ pose, salute, held, state });
  if (state === "done") return ["closing", "Gesture taken. Let the salute go."];
  if (state === "recording" && held)
    return ["salute", "Salute held. Let it go and show the gesture."];
  if (state === "recording")
    return salute > SALUTE
      ? ["closing", "Closing salute seen. Hold it."]
      : ["gesture", "Show the gesture, then salute again."];
  if (salute > SALUTE) return ["salute", "Salute seen. Hold it."];
  return pose ? ["", "Waiting for a Vulcan salute."] : NOBODY;
}

/** Name what begins and ends a take by the language's trigger; no steps where nothing is held. */
export function nameTrigger() {
  const kind = page.gestures?.trigger?.kind ?? "salute";
  const held = kind === "salute" ? "Salute" : "Pose";
  for (const id of ["live-step-salute", "live-step-closing", "live-held"])
    byId(id).textContent = held;
  byId("live-autostop-text").textContent = `Stop after the closing ${endName(page.gestures)}`;
  byId("live-steps").hidden = byId("live-meter").hidden = kind === "gesture" || kind === "none";
}

/**
 * Show where the diver is between the salutes; null while nothing is watched.
 *
 * @param {Seen | null} answer
 */
export function drawState(answer) {
  const [step, text] = answer
    ? situation(answer)
    : ["", HOW_TO[page.gestures?.trigger?.kind ?? "salute"]];
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
  byId("live-slow").hidden = !answer || unhurried || answer.frames_per_second >= FEW;
  byId("live-speed").replaceChildren(
    ...rows.map(([name, value]) => h("div", {}, h("dt", {}, name), h("dd", {}, value))),
  );
}
