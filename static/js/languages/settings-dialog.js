// The settings of the language on display: its profile and voters' weights beside the defaults.

import * as api from "../core/api.js";
import { byId, h, WRITES } from "../core/dom.js";
import { percent, plural, readable } from "../core/format.js";
import { currentLanguage, state } from "../core/state.js";
import { attempt, complain } from "../core/toasts.js";
import { showDone } from "../core/undo.js";
import { edit } from "./revision-edit.js";

/** @import { Language, LanguageSettings, Tuning } from "../core/types.d.ts" */

/** @typedef {{ profile: Language["profile"], weights: Record<string, number>, simplification: number, repaired: boolean | null }} Chosen */

/** @typedef {(focused?: string | null) => void} Draw */

const FACTORS = [0, 0.25, 0.5, 1, 2, 4];

/** @type {Record<Language["profile"], string>} */
const PROFILE_WORDS = {
  full: "Whole movements, weighted distances; movements that are no gesture are rejected.",
  paper: "The paper\u2019s seven voters on trajectory images, by majority; nothing is rejected.",
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
 * @param {Draw} draw
 */
function weightRow(voter, chosen, settings, draw) {
  const factor = chosen.weights[voter] ?? 1;
  const select = h(
    "select",
    { "aria-label": `Weight factor of ${readable(voter)}` },
    [...new Set([...FACTORS, factor])]
      .sort((one, other) => one - other)
      .map((each) => h("option", { value: each }, factorText(each))),
  );
  select.value = String(factor);
  select.onchange = () => {
    chosen.weights[voter] = Number(select.value);
    draw(select.getAttribute("aria-label"));
  };
  const saved = chosen.profile === settings.profile ? settings.weights[voter] : undefined;
  return h(
    "tr",
    { className: factor === 1 ? "" : "changed" },
    h("th", { scope: "row" }, readable(voter)),
    h("td", { className: "num" }, saved === undefined ? "\u2013" : percent(saved)),
    h("td", {}, select),
    h("td", {}, factor === 1 ? "" : "changed"),
  );
}

/**
 * @param {Chosen} chosen
 * @param {LanguageSettings} settings
 * @param {Draw} draw
 */
function profileChoice(chosen, settings, draw) {
  return h(
    "fieldset",
    { className: "settings-profiles" },
    h("legend", {}, "Profile"),
    settings.profiles.map(({ name, voters }) => {
      const input = h("input", { type: "radio", name: "profile", value: name });
      input.checked = name === chosen.profile;
      input.onchange = () => {
        Object.assign(chosen, { profile: name, weights: {} }); // Weights are for its voters.
        draw();
        byId("dialog").querySelector("input[name=profile]:checked")?.focus();
      };
      return h(
        "label",
        {},
        input,
        h(
          "span",
          {},
          h("b", {}, name),
          ` ${plural(voters.length, "voter")}${name === settings.default_profile ? ", the default" : ""}`,
          h("small", { className: "dim" }, PROFILE_WORDS[name]),
        ),
      );
    }),
  );
}

/**
 * @param {Chosen} chosen
 * @param {LanguageSettings} settings
 * @param {Draw} draw
 */
function otherFields(chosen, settings, draw) {
  const drawn = h("input", {
    type: "number",
    id: "settings-simplification",
    min: 0,
    max: settings.most_simplification,
    step: 0.5,
    value: chosen.simplification,
  });
  drawn.onchange = () => {
    const value = drawn.valueAsNumber;
    chosen.simplification = Number.isFinite(value)
      ? Math.min(settings.most_simplification, Math.max(0, value))
      : settings.simplification;
    draw();
  };
  const repaired = h(
    "select",
    { id: "settings-repair" },
    [
      ["", "As the profile does"],
      ["true", "Repaired"],
      ["false", "As the pose model saw them"],
    ].map(([value, text]) => h("option", { value }, text)),
  );
  repaired.value = chosen.repaired === null ? "" : String(chosen.repaired);
  repaired.onchange = () => {
    chosen.repaired = repaired.value === "" ? null : repaired.value === "true";
    draw();
  };
  return [
    h(
      "div",
      { className: "field" },
      h(
        "label",
        { for: drawn.id },
        `Simplification of trajectory images, pixels (default ${settings.simplification})`,
      ),
      drawn,
    ),
    h("div", { className: "field" }, h("label", { for: repaired.id }, "Bad keypoints"), repaired),
  ];
}

/**
 * @param {Chosen} chosen
 * @param {LanguageSettings} settings
 */
async function save(chosen, settings) {
  const change = { profile: chosen.profile, tuning: tuningOf(chosen, settings) };
  try {
    await edit("Saving the settings", "Change of the settings", (language) =>
      api.languages.change(language, change),
    );
    byId("dialog").close();
    showDone("Settings saved", currentLanguage().name);
  } catch (error) {
    complain(error, "Saving the settings");
  }
}

/** Open the settings of the language on display. */
export async function openSettings() {
  const language = state.language ?? "";
  const settings = await attempt("Loading the settings", () => api.languages.settings(language));
  if (!settings) return;
  const dialog = byId("dialog");
  const before = JSON.stringify(chosenIn(settings));
  const chosen = chosenIn(settings);
  const form = h("form", { method: "dialog", className: "settings-dialog", noValidate: true });
  const draw = (/** @type {string | null} */ focused = null) => {
    const profile = settings.profiles.find(({ name }) => name === chosen.profile);
    const changes = countChanges(chosen, settings);
    const reset = h("button", { type: "button", disabled: !changes }, "Reset to the default");
    reset.onclick = () => {
      Object.assign(
        chosen,
        chosenIn({ ...settings, profile: settings.default_profile, tuning: null }),
      );
      draw();
    };
    form.replaceChildren(
      h("h2", { id: "dialog-title" }, "How this language is recognised"),
      h(
        "p",
        { className: "dim", role: "status" },
        changes
          ? `${plural(changes, "setting")} ${changes > 1 ? "differ" : "differs"} from the default.`
          : "Everything is as by default.",
        " The robot does the same.",
      ),
      profileChoice(chosen, settings, draw),
      h(
        "div",
        { className: "settings-voters", tabIndex: 0, role: "group", "aria-label": "Voters" },
        h(
          "table",
          {},
          h(
            "thead",
            {},
            h(
              "tr",
              {},
              ["Voter", "Weight now", "Factor", ""].map((text) =>
                text ? h("th", { scope: "col" }, text) : h("td", {}),
              ),
            ),
          ),
          h(
            "tbody",
            {},
            (profile?.voters ?? []).map((voter) => weightRow(voter, chosen, settings, draw)),
          ),
        ),
      ),
      h("div", { className: "settings-others" }, otherFields(chosen, settings, draw)),
      h(
        "div",
        { className: "dialog-actions" },
        reset,
        h("span", { className: "spacer" }),
        h("button", { type: "button", onclick: () => dialog.close() }, "Cancel"),
        h(
          "button",
          {
            type: "submit",
            className: "primary",
            ...WRITES,
            disabled: JSON.stringify(chosen) === before,
          },
          "Save",
        ),
      ),
    );
    if (focused)
      /** @type {HTMLElement | null} */ (form.querySelector(`[aria-label="${focused}"]`))?.focus();
  };
  form.onsubmit = (event) => {
    event.preventDefault();
    save(chosen, settings);
  };
  draw();
  dialog.replaceChildren(form);
  dialog.setAttribute("aria-labelledby", "dialog-title");
  dialog.onclose = null;
  dialog.showModal();
}
