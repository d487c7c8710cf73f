// The tuning of the language on display: where its recognition differs from the profile.

import * as api from "../core/api.js";
import { byId } from "../core/dom.js";
import { currentLanguage } from "../core/state.js";
import { html, nothing, render } from "../templates.js";
import { edit, editAndShow } from "./revision-edit.js";

/** @import { Language, Recognition, Schemas, State } from "../core/types.d.ts" */

/** @type {Schemas["LanguageChange"]} */
const UNTUNED = { profile: "full", tuning: null };

/**
 * Whether a language has a tuning or another profile than the default.
 *
 * @param {Language | null} language
 */
const differs = (language) =>
  language !== null && (language.profile !== UNTUNED.profile || language.tuning !== null);

/**
 * The words that follow "recognised" for a language's profile and tuning; empty for the default.
 *
 *
 * @param {Language} language
 */
export function tuningWords(language) {
  if (!differs(language)) return "";
  const { profile, tuning, tuning_words: words } = language;
  const tuned = tuning === null ? "" : words;
  return profile === UNTUNED.profile
    ? tuned
    : ["by the profile ", profile, tuned && `, ${tuned}`].join("");
}

/**
 * Save a recognition's tuning in the language; it can be undone.
 *
 * @param {Recognition} recognition
 * @param {string} words
 */
export const keepTuning = ({ profile, tuning }, words) =>
  edit("Keeping the change", `Recognition ${words}`, (language) =>
    api.languages.change(language, { profile, tuning }),
  );

const reset = () =>
  editAndShow(
    "Recognising as before",
    "Recognition as the profile does",
    (language) => api.languages.change(language, UNTUNED),
    ({ name }) => ["Recognised as any language", name],
  );

/**
 * Show the tuning under the gestures, with a button that resets it.
 *
 * @param {State} state
 */
export function drawTuning({ gestures }) {
  const box = byId("tuning");
  box.hidden = !differs(gestures);
  const words = () =>
    html`<span><b>Recognised </b>${tuningWords(currentLanguage())}, here and on the robot.</span>
      <button type="button" class="link" data-writes @click=${reset}>
        As the profile full does
      </button>`;
  render(box.hidden ? nothing : words(), box);
}
