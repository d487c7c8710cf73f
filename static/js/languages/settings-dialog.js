// The settings of the language on display: its profile and voters' weights beside the defaults.

import * as api from "../core/api.js";
import { closeDialog, showDialog } from "../core/dialogs.js";
import { h } from "../core/dom.js";
import { percent, plural, readable } from "../core/format.js";
import { state } from "../core/state.js";
import { attempt } from "../core/toasts.js";
import { html, live, optionsOf, render } from "../templates.js";
import { editAndShow } from "./revision-edit.js";

/** @import { Language, LanguageSettings, Tuning } from "../core/types.d.ts" */

/** @typedef {{ profile: Language["profile"], weights: Record<string, number>, simplification: number, repaired: boolean | null }} Chosen */

/** @typedef {(change: Partial<Chosen>) => void} Put */

/** The factors of a voter's weight that can be chosen. */
export const FACTORS = [0, 0.25, 0.5, 1, 2, 4];

/** @type {Record<Language["profile"], string>} */
const PROFILE_WORDS = {
  full: "Whole movements, weighted distances; movements that are no gesture are rejected.",
  paper:
    "The paper\u2019s seven comparisons of trajectory images, by majority; nothing is rejected.",
};

/** @type {(factor: number) => string} */
const factorText = (factor) => (factor === 0 ? "off" : `${factor} \u00d7`);

/**
 * What is chosen, from a language's settings.
 *
 * @param {Pick<LanguageSettings, "profile" | "tuning" | "simplification">} settings
 * @returns {Chosen}
 */
const chosenIn = ({ profile, tuning, simplification }) => ({
  profile,
  weights: { ...tuning?.weights },
  simplification: tuning?.simplification ?? simplification,
  repaired: tuning?.keypoints_repaired ?? null,
});

/**
 * The tuning as the API takes it; null where nothing differs from the profile.
 *
 * @param {Chosen} chosen
 * @param {LanguageSettings} settings
 * @returns {Tuning | null}
 */
function tuningOf({ weights, simplification, repaired }, settings) {
  const factors = Object.fromEntries(Object.entries(weights).filter(([, factor]) => factor !== 1));
  const drawn = simplification === settings.simplification ? null : simplification;
  if (!Object.keys(factors).length && drawn === null && repaired === null) return null;
  return { weights: factors, simplification: drawn, keypoints_repaired: repaired };
}

/**
 * How many settings differ from the default.
 *
 * @param {Chosen} chosen
 * @param {LanguageSettings} settings
 */
export function countChanges(chosen, settings) {
  const tuning = tuningOf(chosen, settings);
  return (
    Number(chosen.profile !== settings.default_profile) +
    Object.keys(tuning?.weights ?? {}).length +
    Number((tuning?.simplification ?? null) !== null) +
    Number((tuning?.keypoints_repaired ?? null) !== null)
  );
}

/**
 * @param {string} voter
 * @param {Chosen} chosen
 * @param {LanguageSettings} settings
 * @param {Put} put
 */
function weightRow(voter, chosen, settings, put) {
  const factor = chosen.weights[voter] ?? 1;
  const saved = chosen.profile === settings.profile ? settings.weights[voter] : undefined;
  /** @type {[string, string][]} */
  const options = [...new Set([...FACTORS, factor])]
    .sort((one, other) => one - other)
    .map((each) => [String(each), factorText(each)]);
  const weigh = (/** @type {any} */ { target }) =>
    put({ weights: { ...chosen.weights, [voter]: Number(target.value) } });
  return html`<tr class=${factor === 1 ? "" : "changed"}>
    <th scope="row">${readable(voter)}</th>
    <td class="num">${saved === undefined ? "\u2013" : percent(saved)}</td>
    <td>
      <select aria-label="Weight factor of ${readable(voter)}" @change=${weigh}>
        ${optionsOf(options, String(factor))}
      </select>
    </td>
    <td>${factor === 1 ? "" : "changed"}</td>
  </tr>`;
}

/**
 * @param {Chosen} chosen
 * @param {LanguageSettings} settings
 * @param {Put} put
 */
const profileChoice = (chosen, settings, put) =>
  html`<fieldset class="settings-profiles">
    <legend>Profile</legend>
    ${settings.profiles.map(
      ({ name, voters }) =>
        html`<label>
          <input
            type="radio"
            name="profile"
            value=${name}
            .checked=${live(name === chosen.profile)}
            @change=${() => put({ profile: name, weights: {} })}
          />
          <span
            ><b>${name}</b> ${plural(voters.length, "comparison")}${
              name === settings.default_profile ? ", the default" : ""
            }<small class="dim">${PROFILE_WORDS[name]}</small></span
          >
        </label>`,
    )}
  </fieldset>`;

/** @type {[string, string][]} */
const REPAIRS = [
  ["", "As the profile does"],
  ["true", "Repaired"],
  ["false", "As the pose model saw them"],
];

/**
 * @param {Chosen} chosen
 * @param {LanguageSettings} settings
 * @param {Put} put
 */
function otherFields(chosen, settings, put) {
  const { simplification, most_simplification: most } = settings;
  const draws = (/** @type {any} */ { target: { valueAsNumber: value } }) =>
    put({
      simplification: Number.isFinite(value) ? Math.min(most, Math.max(0, value)) : simplification,
    });
  const repairs = (/** @type {any} */ { target: { value } }) =>
    put({ repaired: value === "" ? null : value === "true" });
  return html`<div class="field">
      <label for="settings-simplification"
        >Simplification of trajectory images, pixels (default ${simplification})</label
      >
      <input
        type="number"
        id="settings-simplification"
        min="0"
        max=${most}
        step="0.5"
        .value=${live(String(chosen.simplification))}
        @change=${draws}
      />
    </div>
    <div class="field">
      <label for="settings-repair">Bad keypoints</label>
      <select id="settings-repair" @change=${repairs}>
        ${optionsOf(REPAIRS, String(chosen.repaired ?? ""))}
      </select>
    </div>`;
}

/**
 * @param {Chosen} chosen
 * @param {LanguageSettings} settings
 * @param {Put} put
 */
function fields(chosen, settings, put) {
  const profile = settings.profiles.find(({ name }) => name === chosen.profile);
  const changes = countChanges(chosen, settings);
  const reset = chosenIn({ ...settings, profile: settings.default_profile, tuning: null });
  const same = JSON.stringify(chosen) === JSON.stringify(chosenIn(settings));
  return html`<h2 id="dialog-title">How this language is recognised</h2>
    <p class="dim" role="status">
      ${
        changes
          ? `${plural(changes, "setting")} ${changes > 1 ? "differ" : "differs"} from the default.`
          : "Everything is as by default."
      }
      The robot does the same.
    </p>
    ${profileChoice(chosen, settings, put)}
    <div class="settings-voters" tabindex="0" role="group" aria-label="Comparisons">
      <table>
        <thead>
          <tr>
            <th scope="col">Comparison</th>
            <th scope="col">Weight now</th>
            <th scope="col">Factor</th>
            <td></td>
          </tr>
        </thead>
        <tbody>
          ${profile?.voters.map((voter) => weightRow(voter, chosen, settings, put))}
        </tbody>
      </table>
    </div>
    <div class="settings-others">${otherFields(chosen, settings, put)}</div>
    <div class="dialog-actions">
      <button type="button" ?disabled=${!changes} @click=${() => put(reset)}>
        Reset to the default
      </button>
      <span class="spacer"></span>
      <button type="button" @click=${closeDialog}>Cancel</button>
      <button type="submit" class="primary" data-writes ?disabled=${same}>Save</button>
    </div>`;
}

/**
 * @param {Chosen} chosen
 * @param {LanguageSettings} settings
 */
async function save(chosen, settings) {
  const change = { profile: chosen.profile, tuning: tuningOf(chosen, settings) };
  const saved = await editAndShow(
    "Saving the settings",
    "Change of the settings",
    (language) => api.languages.change(language, change),
    ({ name }) => ["Settings saved", name],
  );
  if (saved) closeDialog();
}

/** Open the settings of the language on display. */
export async function openSettings() {
  const language = state.language ?? "";
  const settings = await attempt("Loading the settings", () => api.languages.settings(language));
  if (!settings) return;
  const chosen = chosenIn(settings);
  const form = h("form", { method: "dialog", className: "settings-dialog", noValidate: true });
  /** @type {Put} */
  const put = (change) => {
    render(fields(Object.assign(chosen, change), settings, put), form);
  };
  form.onsubmit = (event) => {
    event.preventDefault();
    save(chosen, settings);
  };
  put({});
  showDialog(form);
}
