// Another movement for one of two gestures: proposals with drawing and effect, taken by one click.

import { labelInName } from "../clips/clip-label.js";
import { takesLanguage } from "../clips/salutes.js";
import * as api from "../core/api.js";
import { closeDialog, showDialog } from "../core/dialogs.js";
import { h } from "../core/dom.js";
import { currentLanguage, state } from "../core/state.js";
import { html, nothing, render } from "../templates.js";
import { showDone } from "../core/undo.js";
import { labelOf, withoutGesture } from "../gestures/gesture-rows.js";
import { edit } from "../languages/revision-edit.js";
import { effectText } from "./rates.js";

/** @import { Language, Replacement } from "../core/types.d.ts" */

/** @typedef {{ label: string, clip_id: string, start: number, end: number }} TakeDraft */

const MOST_CLIPS = 16; // whose takes are proposed as well, the newest first
const MOST_TAKES = 64; // of one request
const LONGEST_LABEL = 80;

/**
 * The takes of clips that show no gesture of the language and are not named after one.
 *
 * @param {Language} language
 * @returns {Promise<TakeDraft[]>}
 */
async function spareTakes(language) {
  const tested = new Set(state.testSet?.takes.map(({ clip_id: clip }) => clip));
  const spare = withoutGesture(state.clips, language)
    .filter(({ id, status }) => status === "done" && !tested.has(id))
    .filter(({ name }) => !labelInName(name, language.labels));
  const drafts = [];
  for (const { id, name } of spare.slice(0, MOST_CLIPS)) {
    const label = (labelOf(name) || name).slice(0, LONGEST_LABEL);
    const takes = await api.clips.takes(id, takesLanguage(language)).catch(() => []);
    drafts.push(...takes.map(({ start, end }) => ({ label, clip_id: id, start, end })));
  }
  return drafts.slice(0, MOST_TAKES);
}

/**
 * The button that opens the proposals for two gestures.
 *
 * @param {string} one
 * @param {string} other
 */
export const changeButton = (one, other) =>
  html`<button type="button" data-writes @click=${() => propose([one, other])}>
    Change one of the two
  </button>`;

/**
 * @param {Replacement} replacement
 * @param {() => void} take
 */
function card(replacement, take) {
  const { gesture, sign, image } = replacement;
  return html`<li>
    <button type="button" class="replacement" data-writes @click=${take}>
      <img src=${image} alt="" width="96" height="96" /><b>${gesture}</b
      ><span>${effectText(replacement)}</span>${
        sign === null ? nothing : html`<span class="warns">Divers mean “${sign}” by it.</span>`
      }
    </button>
  </li>`;
}

/**
 * Open the proposals for two gestures of the language on display.
 *
 * @param {[string, string]} labels
 */
async function propose(labels) {
  const language = currentLanguage();
  const leaving = new AbortController();
  /** @type {{ label: string, cards: unknown[] }[]} */
  const lists = [];
  const now = { note: "", problem: "", trying: true, taking: false };
  const form = h("form", { method: "dialog", className: "replacements-dialog" });
  /** @param {Partial<typeof now>} change */
  const draw = (change) => {
    const { note, problem, trying, taking } = Object.assign(now, change);
    render(
      html`<h2 id="dialog-title">Change ${labels[0]} or ${labels[1]}</h2>
        <p class="dim" role="status">${note}</p>
        ${trying ? html`<progress aria-label="Comparing movements"></progress>` : nothing}
        <p class="field-problem" role="alert" ?hidden=${!problem}>${problem}</p>
        <div class="replacements" ?inert=${taking}>
          ${lists.map(
            ({ label, cards }) =>
              html`<h3>Instead of ${label}</h3>
                <ul>
                  ${cards}
                </ul>`,
          )}
        </div>
        <div class="dialog-actions">
          <button type="button" @click=${closeDialog}>Cancel</button>
        </div>`,
      form,
    );
  };
  /** @param {any} error */
  const show = (error) => {
    if (leaving.signal.aborted) return;
    if (error.code === "cancelled") closeDialog();
    draw({ problem: error.message });
  };
  /**
   * @param {string} label
   * @param {Replacement} replacement
   * @param {TakeDraft[]} takes
   */
  const take = async (label, { sample, gesture, index }, takes) => {
    draw({ taking: true, problem: "" });
    const shown = index === null ? null : takes[index];
    const movement = shown
      ? { label, demonstration: { ...shown, label: undefined } }
      : { label, sample, gesture };
    try {
      await edit(
        "Changing the movement",
        `Change of ${label}`,
        (base) => api.languages.replaceGesture(base, movement),
        { from: language },
      );
      closeDialog();
      showDone(`${label} has another movement`, gesture);
    } catch (error) {
      show(error);
    } finally {
      draw({ taking: false });
    }
  };
  draw({ note: "Looking for other movements." });
  showDialog(form, () => leaving.abort());
  try {
    const takes = await spareTakes(language);
    let known = "";
    for (const label of labels) {
      if (leaving.signal.aborted) return;
      draw({ note: `Trying other movements for ${label}.` });
      const found = await api.languages.replacements(
        language,
        { label, gestures: takes },
        leaving.signal,
      );
      known ||= found.people ?? "";
      if (!found.replacements.length) continue;
      const cards = found.replacements.map((each) => card(each, () => take(label, each, takes)));
      lists.push({ label, cards });
    }
    draw({ note: known || "No candidate is told apart better." });
  } catch (error) {
    draw({ note: "" });
    show(error);
  } finally {
    draw({ trying: false });
  }
}
