// Edits of a language: each makes a new revision, can be undone, and settles edit conflicts.

import * as api from "../core/api.js";
import { tabStore } from "../core/browser-store.js";
import { currentLanguage, state } from "../core/state.js";
import { attempt } from "../core/toasts.js";
import { recordAction, registerUndo, showDone } from "../core/undo.js";
import { settleConflict } from "./edit-conflict.js";
import { reloadLanguage, reloadLanguages, showNewest } from "./language-store.js";

/** @import { Action, Language } from "../core/types.d.ts" */

const KEY = "osg-studio.heads"; // Beside what can be undone

// Per language the newest revision that this tab made, and the revision whose content it has.
/** @type {Record<string, { revision: number, shows: number }>} */
const heads = tabStore.read(KEY) ?? {};

/**
 * @param {string} language
 * @param {{ revision: number, shows: number }} head
 */
function setHead(language, head) {
  heads[language] = head;
  tabStore.write(KEY, heads);
}

/**
 * Revert a language from one revision's content to another's, as a new revision. Refused where the
 * language has changed since this tab left it: undo must not undo somebody else's edit.
 *
 * @param {string} language
 * @param {number} from
 * @param {number} to
 */
async function revert(language, from, to) {
  const newest = await api.languages.get(language);
  const left = heads[language];
  if (left?.revision !== newest.revision || left.shows !== from)
    throw await changedElsewhere(newest, left?.revision);
  const now = await api.languages.revert(newest, to);
  setHead(language, { revision: now.revision, shows: to });
  await reloadLanguages();
}

/**
 * The error of an undo that would take back what others did, with their changes.
 *
 * @param {Language} newest
 * @param {number} [left]
 */
async function changedElsewhere(newest, left = newest.revision - 1) {
  const revisions = await api.languages.revisions(newest.id);
  const theirs = revisions.filter(({ revision }) => revision > left);
  const named = theirs.slice(0, 3).map(({ revision, change }) => `${revision}, ${change}`);
  const words = named.length ? ` (revision ${named.join("; ")})` : "";
  const error = new Error(
    `The language was changed elsewhere as well${words}. Its history shows every revision, and can go back to any.`,
  );
  return Object.assign(error, { status: 412 });
}

/**
 * Delete a language that this tab made or restored, unless others have changed it since.
 *
 * @param {{ id: string, revision?: number }} action
 */
async function remove({ id, revision }) {
  const newest = await api.languages.get(id);
  const left = heads[id]?.revision ?? revision ?? newest.revision;
  if (newest.revision !== left) throw await changedElsewhere(newest, left);
  await api.languages.remove(newest);
  await reloadLanguages();
}

/** @param {{ id: string }} action */
const restore = ({ id }) => api.languages.restore(id).then(reloadLanguages);

/** @type {(action: Action & { id: string, revision: number }) => Action} */
function record(action) {
  setHead(action.id, { revision: action.revision, shows: action.revision });
  return action;
}

/**
 * Record an edit. Where it began with what an undo or redo has made, it began with what that shows:
 * the edit before it can be undone as well.
 *
 * @type {(action: Action & { language: string, before: number, after: number }) => Action}
 */
function recordEdit(action) {
  const { language, before, after } = action;
  const left = heads[language];
  setHead(language, { revision: after, shows: after });
  return { ...action, before: left?.revision === before ? left.shows : before };
}

registerUndo("language", { undo: restore, redo: remove, record });
registerUndo("created", { undo: remove, redo: restore, record });
registerUndo("edit", {
  undo: ({ language, before, after }) => revert(language, after, before),
  redo: ({ language, before, after }) => revert(language, before, after),
  record: recordEdit,
});

/**
 * Edit the language by `change(base)`, which calls the API with the revision `base`; undo shows it
 * as `title`. `from` is the language that the user began with, `mine` the same after the edit: on a
 * conflict the user chooses between `mine` and the newer revision.
 *
 * @param {string} doing
 * @param {string} title
 * @param {(base: Language) => Promise<Language>} change
 * @param {{ from?: Language, mine?: Language }} [versions]
 */
export async function edit(doing, title, change, { from = currentLanguage(), mine = from } = {}) {
  let made;
  try {
    made = { before: from.revision, language: await change(from) };
  } catch (error) {
    if (error.status !== 412) throw error;
    await reloadLanguage();
    made = await settleConflict({ doing, title, from, mine, change });
  }
  const { before, language } = made;
  if (state.language === language.id) showNewest(language);
  recordAction({ title, kind: "edit", language: language.id, before, after: language.revision });
  return language;
}

/**
 * Edit the language on display as `edit` does, and show what is done, or why it failed. Resolves to
 * the new revision, or to null.
 *
 * @param {string} doing
 * @param {string} title
 * @param {(base: Language) => Promise<Language>} change
 * @param {(made: Language) => [string, string]} done the title and the detail of the message
 * @param {Parameters<typeof edit>[3]} [versions]
 */
export const editAndShow = (doing, title, change, done, versions) =>
  attempt(doing, async () => {
    const language = await edit(doing, title, change, versions);
    showDone(...done(language));
    return language;
  });
