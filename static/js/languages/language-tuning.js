// How the language on display is recognised, where its author kept what differs from the profile.

import * as api from "../core/api.js";
import { byId, h } from "../core/dom.js";
import { state } from "../core/state.js";
import { complain } from "../core/toasts.js";
import { showDone } from "../core/undo.js";
import { edit } from "./revision-edit.js";

const UNTUNED = { profile: "full", tuning: null };

/** Whether a language is recognised otherwise than any other. */
const differs = (language) =>
  Boolean(language) && (language.profile !== UNTUNED.profile || language.tuning !== null);

/** How a language is recognised, after "recognised"; nothing where that is as any other is. */
export function tuningWords(language) {
  if (!differs(language)) return "";
  const { profile, tuning, tuning_words: words } = language;
  const told = tuning === null ? "" : words;
  return profile === UNTUNED.profile
    ? told
    : ["by the profile ", profile, told && `, ${told}`].join("");
}

/** Keep how a recognition was tuned, for the language and so for the robot; it can be taken back. */
export const keepTuning = ({ profile, tuning }, words) =>
  edit("Keeping the change", `Recognition ${words}`, (language) =>
    api.languages.change(language, { profile, tuning }),
  );

async function reset() {
  try {
    await edit("Recognising as before", "Recognition as the profile does", (language) =>
      api.languages.change(language, UNTUNED),
    );
    showDone("Recognised as any language", state.gestures.name);
  } catch (error) {
    complain(error, "Recognising as before");
  }
}

/** Say it under the gestures, with the way back. */
export function drawTuning({ gestures }) {
  const box = byId("tuning");
  box.hidden = !differs(gestures);
  if (box.hidden) return box.replaceChildren();
  return box.replaceChildren(
    h("span", {}, h("b", {}, "Recognised "), tuningWords(gestures), ", here and on the robot."),
    h("button", { type: "button", className: "link", onclick: reset }, "As the profile full does"),
  );
}
