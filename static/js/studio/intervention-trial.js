// The trial of a counterfactual's intervention: recognised again with a copy of the language, which
// is edited only when the intervention is kept.

import * as api from "../core/api.js";
import { h } from "../core/dom.js";
import { currentLanguage, state, update } from "../core/state.js";
import { complain, toast } from "../core/toasts.js";
import { showDone } from "../core/undo.js";
import { keepTuning } from "../languages/language-tuning.js";
import { edit } from "../languages/revision-edit.js";
import { rangeOf, recogniseWith } from "./stage.js";

/** @import { Recognition } from "../core/types.d.ts" */

const currentResult = () => /** @type {Recognition} */ (state.result);

/** What differs from the profile in the recognition on display. */
/** @returns {any} */
const tuning = () => currentResult().tuning ?? currentLanguage().tuning ?? { weights: {} };

/** The weight factors with another one for a voter; 1 is none. */
function withFactor(voter, factor) {
  const weights = { ...tuning().weights, [voter]: factor };
  if (factor === 1) delete weights[voter];
  return weights;
}

const tuned = (part) => ({ tuning: { ...tuning(), ...part } });

const APPLY = {
  trim: (change) => {
    update({ take: null, start: change.start, end: change.end });
    return {};
  },
  voter_weight: ({ voter, factor }) => {
    const { weights } = tuning();
    return tuned({ weights: { ...weights, [voter]: (weights[voter] ?? 1) * factor } });
  },
  weight_factor: ({ voter, factor }) => tuned({ weights: withFactor(voter, factor) }),
  simplification: (change) => tuned({ simplification: change.tolerance }),
  keypoint_repair: (change) => tuned({ keypoints_repaired: change.on }),
  // Weights are for the voters of a profile.
  profile: (change) => ({ profile: change.profile, ...tuned({ weights: {} }) }),
  salient: (change) => changed(change, { salient: change.salient }),
  switch: (change) => changed(change, { [change.switch]: change.position }),
  demonstration: (change) => changed(change, { demonstration: rangeOf() }),
  further_demonstration: (change) => changed(change, { demonstration: rangeOf(), further: true }),
};

/** Changes of how the whole language is recognised. */
const TUNING = new Set([
  "voter_weight",
  "weight_factor",
  "simplification",
  "keypoint_repair",
  "profile",
]);

/** The request's part for a changed gesture. */
const changed = ({ label }, change) => ({ trial: { label, change } });

/** Apply an intervention and recognise again; it can be discarded until it is kept. */
export async function tryOut({ change }) {
  const { recognition, take, start, end, trial } = state;
  const { profile, tuning: before, trial: tried } = currentResult();
  try {
    const result = await recogniseWith({
      profile,
      tuning: before,
      trial: tried,
      ...APPLY[change.kind](change),
    });
    if (result)
      update({
        trial: { change, base: { recognition, take, start, end, trial }, result: result.id },
      });
  } catch (error) {
    complain(error, "Trying the change");
  }
}

const discard = ({ base }) => update({ trial: null, ...base });

/** Edit the gesture as the trial changed its copy. */
const keepGesture = ({ label, change }) =>
  edit("Keeping the change", `Change of ${label}`, (language) =>
    api.languages.changeGesture(language, label, change),
  );

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
    // By the saved language, so that the page shows the robot's result.
    await recogniseWith();
    showDone("Change kept", where);
  } else toast("Range kept", "It is selected now: save it as a gesture, or recognise it again.");
}

/** Show the trial and its result, with buttons to keep or discard it. */
export function trialBar(trial, result) {
  const read = result.label ?? `nothing; nearest is ${result.nearest}`;
  return h(
    "div",
    { className: "trial", role: "status" },
    h(
      "p",
      {},
      h("b", {}, "Trial: "),
      `${trial.change.words}. Recognised as ${read}. Not saved yet.`,
    ),
    h(
      "span",
      { className: "joined" },
      h("button", { type: "button", className: "primary", onclick: () => keep(trial) }, "Keep"),
      h("button", { type: "button", onclick: () => discard(trial) }, "Discard"),
    ),
  );
}
