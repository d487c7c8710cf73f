// Requests of a draft: its preview, and saving it as one revision.

import * as api from "../core/api.js";
import { edit } from "../languages/revision-edit.js";
import { read } from "../languages/robot-command.js";

/** @import { Gesture, Language, SwitchName } from "../core/types.d.ts" */

/** @import { Draft } from "./gesture-draft.js" */

/** @typedef {Partial<Omit<Gesture, "source">> & { demonstration?: Draft["clip"] }} Change */

/** @type {SwitchName[]} */
const SWITCHES = ["direction", "tempo", "mirror", "hand_shape"];

/**
 * @param {unknown} one
 * @param {unknown} other
 */
const same = (one, other) => JSON.stringify(one) === JSON.stringify(other);

/**
 * Whether a draft has another demonstration than the saved gesture.
 *
 * @param {string | null} gesture
 * @param {Pick<Draft, "clip">} values
 * @param {Draft} saved
 */
const isAnew = (gesture, { clip }, saved) =>
  Boolean(clip) && (gesture === null || !same(clip, saved.clip));

/**
 * The values of a draft that affect recognition.
 *
 * @param {Draft} draft
 * @param {boolean} anew
 */
function content({ clip, salient, ...values }, anew) {
  return {
    ...(anew ? { demonstration: clip } : {}),
    ...(salient ? { salient } : {}),
    ...Object.fromEntries(SWITCHES.map((name) => [name, values[name]])),
  };
}

/**
 * The request for a preview. A drawing without its demonstration keeps its keypoints (`fixed`).
 *
 * @param {string | null} gesture
 * @param {Draft} values
 * @param {Draft} saved
 * @param {boolean} [fixed]
 */
export const requestOf = (gesture, values, saved, fixed = false) => ({
  label: gesture,
  change: content(fixed ? { ...values, salient: null } : values, isAnew(gesture, values, saved)),
});

/**
 * The gesture of the language that a draft is called, or null.
 *
 * @param {Language} language
 * @param {Pick<Draft, "label">} values
 */
export const knownLabel = ({ labels }, { label }) =>
  labels.find((each) => each === label.trim()) ?? null;

/**
 * The change by which a draft becomes a further demonstration of a gesture.
 *
 * @param {Draft} values
 */
export const furtherOf = ({ clip, salient }) => ({
  demonstration: clip,
  further: true,
  ...(salient ? { salient } : {}),
});

/**
 * Only the changed values: somebody else may meanwhile have edited the others.
 *
 * @param {string} gesture
 * @param {Draft} values
 * @param {Draft} saved
 */
function changeOf(gesture, values, saved) {
  /** @type {Change} */
  const change = {};
  const anew = isAnew(gesture, values, saved);
  for (const name of /** @type {const} */ (["label", "description"]))
    if (values[name].trim() !== saved[name]) change[name] = values[name].trim();
  if (values.command !== saved.command) change.command = read(values.command).command;
  for (const name of SWITCHES) if (values[name] !== saved[name]) change[name] = values[name];
  if (anew) change.demonstration = values.clip;
  if (values.salient && (anew || !same(values.salient, saved.salient)))
    change.salient = values.salient;
  return change;
}

/**
 * Save a draft as one revision of the language, which can be undone.
 *
 * @param {Language} language
 * @param {string | null} gesture
 * @param {Draft} values
 * @param {Draft} saved
 */
export function save(language, gesture, values, saved) {
  if (gesture === null) {
    const { clip, label, description, command, ...rest } = values;
    const known = knownLabel(language, values);
    if (known)
      return edit(
        "Adding the demonstration",
        `Further demonstration of ${known}`,
        (base) => api.languages.changeGesture(base, known, furtherOf(values)),
        { from: language },
      );
    /** @type {any} */
    const body = {
      ...rest,
      ...clip,
      label: label.trim(),
      description: description.trim(),
      command: read(command).command,
    };
    return edit(
      "Saving the gesture",
      `New gesture ${body.label}`,
      (base) => api.languages.addGesture(base, body),
      { from: language },
    );
  }
  const change = changeOf(gesture, values, saved);
  const mine = {
    ...language,
    gestures: language.gestures.map((each) =>
      each.label === gesture ? { ...each, ...change } : each,
    ),
  };
  return edit(
    "Changing the gesture",
    `Change of ${gesture}`,
    (base) => api.languages.changeGesture(base, gesture, change),
    { from: language, mine },
  );
}
