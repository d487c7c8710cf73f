// What was done here and can be taken back, and done again: across reloads, until the tab closes.

import * as api from "./api.js";
import { reloadClips, select } from "../clips/clip-list.js";
import { byId } from "./dom.js";
import { bind } from "./keys.js";
import { reloadLanguages } from "../languages/language-store.js";
import { complain, toast } from "./toasts.js";

const KEY = "osg-studio.undo"; // sessionStorage: a tab takes back what was done in it.
const MOST = 100;

const stored = () => {
  try {
    return JSON.parse(sessionStorage.getItem(KEY));
  } catch {
    return null;
  }
};

// heads: per language its newest revision as this tab left it, and the one whose content that shows.
let { done, undone, heads } = stored() ?? { done: [], undone: [], heads: {} };

/**
 * Remember something done. `deed` is plain data, `{ title, kind, ... }`, of one of these kinds:
 * `edit`: `{ language, before, after }` revisions of a language; `clip`, `language`: `{ id }` of
 * something deleted; `created`: `{ id }` of a language made.
 */
export function did(deed) {
  done = [...done, deed].slice(-MOST);
  undone = [];
  if (deed.kind === "edit") heads[deed.language] = { revision: deed.after, shows: deed.after };
  keep();
}

const KINDS = {
  edit: {
    back: ({ language, before, after }) => turn(language, after, before),
    again: ({ language, before, after }) => turn(language, before, after),
  },
  clip: {
    back: ({ id }) =>
      api.clips
        .restore(id)
        .then(reloadClips)
        .then(() => select(id)),
    again: ({ id }) => api.clips.remove(id).then(reloadClips),
  },
  language: {
    back: ({ id }) => api.languages.restore(id).then(reloadLanguages),
    again: ({ id }) => api.languages.remove({ id }).then(reloadLanguages),
  },
  created: {
    back: ({ id }) => api.languages.remove({ id }).then(reloadLanguages),
    again: ({ id }) => api.languages.restore(id).then(reloadLanguages),
  },
};

/**
 * Turn a language from one revision's content to another's, which makes a new revision. Only where
 * it still is as this tab left it: taking back must not take back what somebody else did.
 */
async function turn(language, from, to) {
  const head = await api.languages.get(language);
  const left = heads[language];
  if (left?.revision !== head.revision || left.shows !== from) {
    throw Object.assign(
      new Error(
        `The language was changed elsewhere as well; its newest revision is ${head.revision}. Its history shows every revision, and can go back to any.`,
      ),
      { status: 412 },
    );
  }
  const now = await api.languages.revert(head, to);
  heads[language] = { revision: now.revision, shows: to };
  await reloadLanguages();
}

async function step(from, to, how, words) {
  const deed = from.at(-1);
  if (!deed) return;
  try {
    await KINDS[deed.kind][how](deed);
    from.pop();
    to.push(deed);
    keep();
    forgetOffers();
    toast(words, deed.title);
  } catch (error) {
    complain(error, words);
  }
}

// One after the other: a second key press may come while the first still waits for the server.
let working = Promise.resolve();

/** Take back the newest deed; resolves when that is done. */
export const undo = () => (working = working.then(() => step(done, undone, "back", "Undone")));

/** Do again what was taken back last; resolves when that is done. */
export const redo = () => (working = working.then(() => step(undone, done, "again", "Done again")));

function keep() {
  sessionStorage.setItem(KEY, JSON.stringify({ done, undone, heads }));
}

/** Undo takes back the newest deed, so older messages must not offer it any more. */
function forgetOffers() {
  for (const other of byId("toasts").querySelectorAll(".undoable")) other.remove();
}

/** Show what was done, with a button that takes it back. */
export function tellDone(title, detail = "") {
  forgetOffers();
  const told = toast(title, detail, { action: { label: "Undo", run: undo } });
  told.classList.add("undoable");
}

/** Wire the keys. */
export function bindUndo() {
  bind({ keys: ["Ctrl+Z"], text: "Undo", group: "Everywhere", run: undo });
  bind({ keys: ["Ctrl+Shift+Z", "Ctrl+Y"], text: "Redo", group: "Everywhere", run: redo });
}
