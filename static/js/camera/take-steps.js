// The steps of a take before the camera, in words: what is awaited, what is seen, what comes next.

import { SALUTE } from "../clips/salute-threshold.js";
import { state as page } from "../core/state.js";

/** @import { Seen } from "./live-messages.d.ts" */

const HOW_TO = {
  salute: "Hold a Vulcan salute, show the gesture, salute again.",
  pose: "Hold the pose of the arms, show the gesture, hold the closing pose.",
  gesture: "Show the gesture that begins a take, then gestures, then the one that ends it.",
  none: "Show a gesture, with rest before and after it.",
};

/** How a take is shown, by the trigger of the language on display. */
export const howTo = () => HOW_TO[page.gestures?.trigger?.kind ?? "salute"];

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
export function situation({ pose, salute, held, state }) {
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
