// Actions on a whole language; each can be undone.

import * as api from "../core/api.js";
import { ask } from "../core/dialogs.js";
import { state, update } from "../core/state.js";
import { attempt } from "../core/toasts.js";
import { recordAction, showDone } from "../core/undo.js";
import { begin, choose, reloadLanguages } from "./language-store.js";
import { edit } from "./revision-edit.js";

/** @import { LanguageSummary, SampleLanguage } from "../core/types.d.ts" */

/**
 * Ask for another name and author.
 *
 * @param {LanguageSummary} language
 */
export async function rename({ id }) {
  const language = await attempt("Loading the language", () => api.languages.get(id));
  if (!language) return null;
  return ask({
    title: "Rename language",
    fields: [
      { name: "name", label: "Name", value: language.name, required: true, most: 80 },
      {
        name: "author",
        label: "Author",
        value: language.author,
        most: 200,
        hint: "Who made it; written into the file and the history.",
      },
    ],
    action: "Save",
    submit: async (values) => {
      const change = Object.fromEntries(
        Object.entries(values).filter(
          ([name, value]) => value !== language[/** @type {"name" | "author"} */ (name)],
        ),
      );
      if (!Object.keys(change).length) return language;
      const mine = { ...language, ...change };
      return edit(
        "Renaming the language",
        `Renaming of ${language.name}`,
        (base) => api.languages.change(base, change),
        { from: language, mine },
      );
    },
  });
}

/**
 * Make a copy and work on it.
 *
 * @param {LanguageSummary} language
 */
export async function duplicate({ id, name }) {
  const copy = await attempt("Duplicating the language", () => api.languages.duplicate(id));
  if (copy) await begin(copy, `Copy of ${name}`, "Language duplicated");
}

/**
 * Delete a language, unless it changed since it was shown.
 *
 * @param {LanguageSummary} language
 */
export async function remove(language) {
  const done = await attempt("Deleting the language", async () => {
    await api.languages.remove(language);
    return true;
  });
  if (!done) return reloadLanguages();
  const { id, revision } = language;
  recordAction({ title: `Deletion of ${language.name}`, kind: "language", id, revision });
  if (state.language === language.id) update({ language: null, recognition: null });
  await reloadLanguages();
  return showDone("Language deleted", language.name);
}

/**
 * Show a language's history, with its newest revision compared to the one before.
 *
 * @param {LanguageSummary} language
 */
export async function openHistory({ id }) {
  await choose(id);
  update({ panel: "history", older: null, newer: null });
}

/**
 * Add a sample language, also one that was deleted.
 *
 * @param {SampleLanguage} sample
 */
export async function addSampleLanguage({ name, title }) {
  const language = await attempt("Adding the sample", () => api.samples.addLanguage(name));
  if (language) await begin(language, `Sample ${title}`, "Sample language added");
}
