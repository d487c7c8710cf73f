// Another movement for one of two gestures: proposals with drawing and effect, taken by one click.

import { labelInName } from "../clips/clip-label.js";
import { takesLanguage } from "../clips/salutes.js";
import * as api from "../core/api.js";
import { byId, h, WRITES } from "../core/dom.js";
import { currentLanguage, state } from "../core/state.js";
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
  h(
    "button",
    { type: "button", ...WRITES, onclick: () => propose([one, other]) },
    "Change one of the two",
  );

/**
 * @param {Replacement} replacement
 * @param {() => void} take
 */
function card(replacement, take) {
  const { gesture, sign, image } = replacement;
  return h(
    "li",
    {},
    h(
      "button",
      { type: "button", className: "replacement", ...WRITES, onclick: take },
      h("img", { src: image, alt: "", width: 96, height: 96 }),
      h("b", {}, gesture),
      h("span", {}, effectText(replacement)),
      sign === null
        ? null
        : h("span", { className: "warns" }, `Divers mean \u201c${sign}\u201d by it.`),
    ),
  );
}

/**
 * Open the proposals for two gestures of the language on display.
 *
 * @param {[string, string]} labels
 */
async function propose(labels) {
  const dialog = byId("dialog");
  const language = currentLanguage();
  const leaving = new AbortController();
  const note = h("p", { className: "dim", role: "status" });
  const problem = h("p", { className: "field-problem", role: "alert", hidden: true });
  const progress = h("progress", { "aria-label": "Comparing movements" });
  const lists = h("div", { className: "replacements" });
  /** @param {any} error */
  const show = (error) => {
    if (leaving.signal.aborted) return;
    if (error.code === "cancelled") dialog.close();
    problem.textContent = error.message;
    problem.hidden = false;
  };
  /**
   * @param {string} label
   * @param {Replacement} replacement
   * @param {TakeDraft[]} takes
   */
  const take = async (label, { sample, gesture, index }, takes) => {
    lists.inert = true;
    problem.hidden = true;
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
      dialog.close();
      showDone(`${label} has another movement`, gesture);
    } catch (error) {
      show(error);
    } finally {
      lists.inert = false;
    }
  };
  dialog.replaceChildren(
    h(
      "form",
      { method: "dialog", className: "replacements-dialog" },
      h("h2", { id: "dialog-title" }, `Change ${labels[0]} or ${labels[1]}`),
      note,
      progress,
      problem,
      lists,
      h(
        "div",
        { className: "dialog-actions" },
        h("button", { type: "button", onclick: () => dialog.close() }, "Cancel"),
      ),
    ),
  );
  dialog.setAttribute("aria-labelledby", "dialog-title");
  dialog.onclose = () => leaving.abort();
  dialog.showModal();
  try {
    note.textContent = "Looking for other movements.";
    const takes = await spareTakes(language);
    let known = "";
    for (const label of labels) {
      if (leaving.signal.aborted) return;
      note.textContent = `Trying other movements for ${label}.`;
      const found = await api.languages.replacements(
        language,
        { label, gestures: takes },
        leaving.signal,
      );
      known ||= found.people ?? "";
      if (!found.replacements.length) continue;
      const cards = found.replacements.map((each) => card(each, () => take(label, each, takes)));
      lists.append(h("h3", {}, `Instead of ${label}`), h("ul", {}, cards));
    }
    note.textContent = known || "No candidate is told apart better.";
  } catch (error) {
    note.textContent = "";
    show(error);
  } finally {
    progress.remove();
  }
}
