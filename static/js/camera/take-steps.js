// The steps of a take before the camera, in words: what is awaited, what is seen, what comes next.

import { SALUTE } from "../clips/salute-threshold.js";

/** @import { Seen } from "./live-messages.d.ts" */

const FEW = 6; // frames a second; with fewer, a gesture of 1 s has at most five points.

/** @type {Record<string, string>} */
const HOW_TO = {
  salute: "Hold a Vulcan salute, show the gesture, salute again.",
  pose: "Hold the pose of the arms, show the gesture, hold the closing pose.",
  gesture: "Show the gesture that begins a take, then gestures, then the one that ends it.",
  none: "Show a gesture, with rest before and after it.",
};

/**
 * How a take is shown, by the kind of trigger.
 *
 * @param {string} [kind]
 */
export const howTo = (kind = "salute") => HOW_TO[kind];

/**
 * Whether too few frames are looked at to see a gesture.
 *
 * @param {Seen} message
 */
export const isSlow = ({ frames_per_second: rate }) => rate < FEW;

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
 * The diver's step and the next instruction, from a message of the server and the kind of trigger.
 *
 * @param {Pick<Seen, "pose" | "salute" | "held" | "state">} message
 * @param {string} [kind]
 */
export function situation({ pose, salute, held, state }, kind = "salute") {
  if (kind === "pose") return posed({ pose, salute, held, state });
  if (kind !== "salute") return pose ? ["gesture", "Show a gesture."] : NOBODY;
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
