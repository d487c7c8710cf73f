// Salutes along a clip: runs of frames whose salute score is above the threshold.

import { plural } from "../core/format.js";
import { follow } from "../core/state.js";
import { elementOf, html, iconOf } from "../templates.js";
import { SALUTE } from "./salute-threshold.js";

/** @import { Clip, Language } from "../core/types.d.ts" */

const HOLD = 0.3; // s: the shortest salute, `HOLD_SECONDS` in recording/salute.py.
const OVERLAP = 0.1; // s; a shorter part of a salute in a range is the take's edge.

/**
 * The language whose trigger finds the takes; null if that trigger is the salute, the default.
 *
 * @param {Language | null} language
 */
export const takesLanguage = (language) => (language?.trigger ? language.id : null);

const HELD = { salute: "Vulcan salute", pose: "arm pose", gesture: "gesture", none: "gesture" };

/**
 * What a diver holds before and after a gesture of a language; "gesture" where nothing is held.
 *
 * @param {Language | null} language
 */
export const heldName = (language) => HELD[language?.trigger?.kind ?? "salute"];

/**
 * What ends a take, as the noun of a sentence: "salute", "arm pose" or "gesture".
 *
 * @param {Language | null} language
 */
export const endName = (language) => heldName(language).replace("Vulcan ", "");

/**
 * What was found wanting in a clip, as far as it concerns a language with this trigger.
 *
 * @param {Clip} clip
 * @param {Language | null} language
 */
export const listWarnings = (clip, language) => [
  ...(clip.warnings ?? []),
  ...(endName(language) === "salute" ? (clip.salute_warnings ?? []) : []),
];

/**
 * The salutes that overlap a range: `[start, end]` in seconds of the clip.
 *
 * @param {{ time: number[], salute: number[] }} timeline
 * @param {number} start
 * @param {number} end
 * @returns {[number, number][]}
 */
export function salutesIn({ time, salute }, start, end) {
  /** @type {[number, number][]} */
  const runs = [];
  let first = -1;
  for (let frame = 0; frame <= time.length; frame += 1) {
    const held = frame < time.length && salute[frame] >= SALUTE;
    if (held && first < 0) first = frame;
    if (held || first < 0) continue;
    runs.push([time[first], time[frame - 1]]);
    first = -1;
  }
  return runs.filter(
    ([from, to]) => to - from >= HOLD && Math.min(to, end) - Math.max(from, start) >= OVERLAP,
  );
}

/**
 * A warning about the salutes in a range; empty without any.
 *
 * @param {[number, number][]} salutes
 * @param {string} [name] what a diver holds: `heldName`
 */
export const saluteWarning = (salutes, name = "Vulcan salute") =>
  salutes.length
    ? `This range contains ${plural(salutes.length, name)}, which would become part of the gesture. Choose a take, or a range between the ${name === "arm pose" ? "poses" : "salutes"}.`
    : "";

/** The hand of a salute, while the language on display has it as trigger. */
export function saluteHand() {
  const hand = elementOf(
    html`<div role="img" aria-label="Hand in a Vulcan salute">${iconOf("salute")}</div>`,
  );
  follow(["gestures"], ({ gestures }) => {
    hand.hidden = heldName(gestures) !== HELD.salute;
  });
  return hand;
}
