// The languages as the server has them: loading, selecting, creating and importing.

import * as api from "../core/api.js";
import { browserStore } from "../core/browser-store.js";
import { ask } from "../core/dialogs.js";
import { plural } from "../core/format.js";
import { loadList, refresh } from "../core/list-refresh.js";
import { state, update } from "../core/state.js";
import { attempt } from "../core/toasts.js";
import { recordAction, showDone } from "../core/undo.js";

/** @import { Language, LanguageSummary } from "../core/types.d.ts" */

const LAST = "osg-studio.language"; // A new tab starts with the language used last.

export async function reloadLanguages() {
  const languages = await attempt("Loading the languages", () =>
    loadList("languages", api.languages.list),
  );
  if (!languages) return;
  const wanted = [state.language, browserStore.get(LAST)].find((id) =>
    languages.some((each) => each.id === id),
  );
  update({ languages, language: wanted ?? firstLanguage(languages)?.id ?? null });
  await reloadLanguage();
}

/**
 * Load one language that changed.
 *
 * @param {string} id
 */
export const reloadOneLanguage = (id) =>
  refresh(id, {
    list: "languages",
    load: api.languages.get,
    current: () => state.languages,
    order: (one, other) =>
      one.created.localeCompare(other.created) || one.id.localeCompare(other.id),
    take: (languages, language) => {
      update({ languages });
      if (id !== state.language) return;
      if (language) showNewest(language);
      else reloadLanguages();
    },
  });

/** The misread sample clip: its name, the gesture that it shows, and the one recognised instead. */
export const MISREAD = { name: "unfinished-triangle.mp4", expected: "triangle", read: "wedge" };

/**
 * Whether a language misreads the sample clip, because it has both gestures.
 *
 * @param {LanguageSummary} language
 */
export const knowsSampleClips = ({ labels }) =>
  labels.includes(MISREAD.expected) && labels.includes(MISREAD.read);

/**
 * The language of a first visit: one that recognises the sample clips, or else the first.
 *
 * @param {LanguageSummary[]} languages
 * @returns {LanguageSummary | null}
 */
const firstLanguage = (languages) => languages.find(knowsSampleClips) ?? languages[0] ?? null;

/** Load the gestures of the language on display. */
export async function reloadLanguage() {
  const id = state.language;
  if (!id) return update({ gestures: null });
  browserStore.set(LAST, id);
  const language = await attempt("Loading the language", () => api.languages.get(id));
  if (language && state.language === id) showNewest(language);
  return undefined;
}

/**
 * Show a language, unless a newer revision of it is on display: answers may arrive out of order.
 *
 * @param {Language} language
 */
export function showNewest(language) {
  const shown = state.gestures;
  if (shown?.id === language.id && shown.revision > language.revision) return;
  update({ gestures: language });
}

/**
 * Work on another language.
 *
 * @param {string | null} id
 */
export function choose(id) {
  if (id !== state.language) update({ language: id, recognition: null });
  return reloadLanguage();
}

/**
 * Select a language that was just made; this can be undone.
 *
 * @param {Language} language
 * @param {string} title
 * @param {string} words
 */
export async function begin(language, title, words) {
  recordAction({ title, kind: "created", id: language.id, revision: language.revision });
  update({ languages: await loadList("languages", api.languages.list) });
  await choose(language.id);
  showDone(words, `${language.name}, ${plural(language.gestures.length, "gesture")}`);
}

/**
 * Ask for a name and make an empty language; resolves to it, or null.
 *
 * @param {{ text?: string, preview?: HTMLElement | null }} [question]
 */
export function newLanguage({
  text = "A language is a set of gestures that one robot understands.",
  preview = null,
} = {}) {
  return ask({
    title: "New language",
    text,
    preview,
    fields: [{ name: "name", label: "Name", required: true, most: 80, value: "My gestures" }],
    action: "Create",
    submit: async ({ name }) => {
      const language = await api.languages.create(name);
      await begin(language, `Creation of ${name}`, "Language made");
      return language;
    },
  });
}

/**
 * Import a language file, ours or the published format.
 *
 * @param {File} file
 */
export async function importLanguage(file) {
  const language = await attempt(`Importing ${file.name}`, async () =>
    api.languages.import(file.name.replace(/\.json$/i, ""), await file.text()),
  );
  if (language) await begin(language, `Import of ${file.name}`, "Language imported");
}
