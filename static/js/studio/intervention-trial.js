// The trial of a counterfactual's intervention: the take is recognised again with a changed copy of
// the language; the language itself is edited only when the intervention is kept.

import * as api from "../core/api.js";
import { askWhich } from "../core/format.js";
import { currentLanguage, state, update } from "../core/state.js";
import { complain, toast } from "../core/toasts.js";
import { showDone } from "../core/undo.js";
import { keepTuning } from "../languages/language-tuning.js";
import { edit } from "../languages/revision-edit.js";
import { html } from "../templates.js";
import { rangeOf, recogniseWith } from "./studio-view.js";

/** @import { Intervention, Recognition, Trial, Tuning } from "../core/types.d.ts" */

const currentResult = () => /** @type {Recognition} */ (state.result);

/**
 * The tuning of the recognition on display.
 *
 * @returns {Tuning}
 */
const tuning = () => currentResult().tuning ?? currentLanguage().tuning ?? { weights: {} };

/**
 * The weight factors with another one for a voter; a factor of 1 is left out.
 *
 * @param {string} voter
 * @param {number} factor
 */
function withFactor(voter, factor) {
  const weights = { ...tuning().weights, [voter]: factor };
  if (factor === 1) delete weights[voter];
  return weights;
}

/** @param {Partial<Tuning>} part */
const tuned = (part) => ({ tuning: { ...tuning(), ...part } });

/**
 * The request's part for a changed gesture.
 *
 * @param {string} label
 * @param {object} change
 */
const changed = (label, change) => ({ trial: { label, change } });

/**
 * The request's part for an intervention; a trim changes the selection instead.
 *
 * @param {Intervention} change
 */
function requestOf(change) {
  switch (change.kind) {
    case "trim":
      update({ take: null, start: change.start, end: change.end });
      return {};
    case "weight_factor":
      return tuned({ weights: withFactor(change.voter, change.factor) });
    case "keypoint_repair":
      return tuned({ keypoints_repaired: change.on });
    case "switch":
      return changed(change.label, { [change.switch]: change.position });
    case "demonstration_cut": {
      const { clip_id, clip_start: start, clip_end: end } = change;
      return changed(change.label, { demonstration: { clip_id, start, end } });
    }
    case "further_demonstration":
      return changed(change.label, { demonstration: rangeOf(), further: true });
  }
}

/** Changes that affect the whole language. */
const TUNING = new Set(["weight_factor", "keypoint_repair"]);

/**
 * Apply an intervention and recognise again; it can be discarded until it is kept.
 *
 * @param {{ change: Intervention }} found
 */
export async function tryOut({ change }) {
  const { recognition, take, start, end, trial } = state;
  const { profile, tuning: before, trial: tried } = currentResult();
  try {
    const result = await recogniseWith({
      profile,
      tuning: before,
      trial: tried,
      ...requestOf(change),
    });
    if (result)
      update({
        trial: { change, base: { recognition, take, start, end, trial }, result: result.id },
      });
  } catch (error) {
    complain(error, "Trying the change");
  }
}

/** @param {Trial} trial */
const discard = ({ base }) => update({ trial: null, ...base });

/**
 * Apply the trial's change of the gesture to the language.
 *
 * @param {NonNullable<Recognition["trial"]>} trial
 */
const keepGesture = ({ label, change }) =>
  edit("Keeping the change", `Change of ${label}`, (language) =>
    api.languages.changeGesture(language, label, change),
  );

/** @param {Trial} trial */
async function keep({ change }) {
  const result = currentResult();
  const { words } = change;
  const where = `${words}, in ${currentLanguage().name}`;
  try {
    if (result.trial) await keepGesture(result.trial);
    if (result.tuning !== null || TUNING.has(change.kind)) await keepTuning(result, words);
  } catch (error) {
    complain(error, "Keeping the change");
    return;
  }
  update({ trial: null });
  if (result.trial || TUNING.has(change.kind)) {
    // Recognise again with the saved language, so that the page shows the robot's result.
    await recogniseWith();
    showDone("Change kept", where);
  } else toast("Range kept", "It is selected now: save it as a gesture, or recognise it again.");
}

/**
 * Show the trial and its result, with buttons to keep or discard it.
 *
 * @param {Trial} trial
 * @param {Recognition} result
 */
export function trialBar(trial, result) {
  const read = result.pair
    ? askWhich(result.pair)
    : `${result.label ?? `nothing; nearest is ${result.nearest}`}.`;
  return html`<div class="trial" role="status">
    <p>
      <b>Trial: </b>${trial.change.words}.
      ${result.without?.length ? "Read without itself as" : "Recognised as"} ${read} Not saved yet.
    </p>
    <span class="joined"
      ><button type="button" class="primary" data-writes @click=${() => keep(trial)}>Keep</button
      ><button type="button" @click=${() => discard(trial)}>Discard</button></span
    >
  </div>`;
}
