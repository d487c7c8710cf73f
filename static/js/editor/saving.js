// A draft as the server takes it: to preview it, and to save it as one revision.

import * as api from "../api.js";
import { edit } from "../gestures.js";
import { read } from "./command.js";

const SWITCHES = ["direction", "tempo", "mirror"];

/** What of a draft changes what is recognised. */
function content({ clip, salient, ...values }) {
  return {
    ...(clip ? { demonstration: clip } : {}),
    ...(salient ? { salient } : {}),
    ...Object.fromEntries(SWITCHES.map((name) => [name, values[name]])),
  };
}

/** What is asked of the preview. A drawing without its demonstration keeps its keypoints. */
export const requestOf = (gesture, values, fixed = false) => ({ label: gesture, change: content(fixed ? { ...values, salient: null } : values) });

/** Only what was changed: the rest may meanwhile be another's. */
function changeOf(values, saved) {
  const change = {};
  for (const name of ["label", "description"]) if (values[name].trim() !== saved[name]) change[name] = values[name].trim();
  if (values.command !== saved.command) change.command = read(values.command).command;
  for (const name of SWITCHES) if (values[name] !== saved[name]) change[name] = values[name];
  if (values.clip) change.demonstration = values.clip;
  const chosen = JSON.stringify(values.salient) !== JSON.stringify(saved.salient) || values.clip;
  if (values.salient && chosen) change.salient = values.salient;
  return change;
}

/** Save a draft as one revision of the language, which can be taken back. */
export function save(language, gesture, values, saved) {
  if (gesture === null) {
    const { clip, label, description, command, ...rest } = values;
    const body = { ...rest, ...clip, label: label.trim(), description: description.trim(), command: read(command).command };
    return edit("Saving the gesture", `New gesture ${body.label}`, (base) => api.languages.addGesture(base, body), { from: language });
  }
  const change = changeOf(values, saved);
  const mine = { ...language, gestures: language.gestures.map((each) => (each.label === gesture ? { ...each, ...change } : each)) };
  return edit("Changing the gesture", `Change of ${gesture}`, (base) => api.languages.changeGesture(base, gesture, change), { from: language, mine });
}
