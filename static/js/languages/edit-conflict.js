// The dialog for an edit conflict: two edits of one revision side by side, for the user to choose.

import * as api from "../core/api.js";
import { h } from "../core/dom.js";
import { ago } from "../core/format.js";
import { html, nothing, render } from "../templates.js";
import { changedTexts, diffGestures } from "./draft-diff.js";

/** @import { Gesture, Language } from "../core/types.d.ts" */

const cancelled = () =>
  Object.assign(new Error("The other change was kept; yours was dropped."), { code: "cancelled" });

/** @param {string} doing */
const undecided = (doing) =>
  Object.assign(
    new Error(
      "Nothing was saved: the language was changed in another tab meanwhile. Save again to choose between the two.",
    ),
    { title: `${doing} failed`, status: 412 },
  );

/**
 * One version: its changes, and its gestures with the kind of each.
 *
 * @param {string} title
 * @param {string[]} lines
 * @param {{ gesture: Gesture, kind: string }[]} gestures
 * @param {unknown} choice
 */
const version = (title, lines, gestures, choice) =>
  html`<section aria-label=${title}>
    <h3>${title}</h3>
    <ul class="conflict-changes">
      ${lines.map((line) => html`<li>${line}</li>`)}
    </ul>
    <ul class="conflict-gestures">
      ${gestures.map(
        ({ gesture, kind }) =>
          html`<li class=${kind}>
            <img src=${api.beside(gesture.thumbnail)} alt="" width="56" height="56" />
            <span>${gesture.label}</span>
            ${kind === "same" ? nothing : html`<small>${kind}</small>`}
          </li>`,
      )}
    </ul>
    ${choice}
  </section>`;

/**
 * The changes since `from`, one line each.
 *
 * @param {Language} from
 */
async function deedsSince(from) {
  const revisions = await api.languages.revisions(from.id);
  return revisions
    .filter((each) => each.revision > from.revision)
    .reverse()
    .map((each) => `${each.change} (revision ${each.revision}, ${ago(each.created)})`);
}

/**
 * Let the user choose. Resolves to `{ before, language }`: the revision that was edited, and the
 * language after the edit. Throws `cancelled` if the other edit is kept, and a 412 without a
 * choice.
 *
 * @param {{ doing: string, title: string, from: Language, mine: Language, change: (base: Language) => Promise<Language> }} edit
 */
export async function settleConflict({ doing, title, from, mine, change }) {
  const [theirs, deeds] = await Promise.all([api.languages.get(from.id), deedsSince(from)]);
  const compared = await api.languages.compare(from.id, from.revision, theirs.revision);
  const theirGestures = compared.gestures.map(({ kind, before, after }) => ({
    gesture: /** @type {Gesture} */ (after ?? before),
    kind,
  }));
  const theirWords = [
    ...compared.words,
    ...compared.gestures.flatMap(({ before, after, words }) =>
      words.map((word) => `${(after ?? before)?.label}: ${word}`),
    ),
  ];
  const dialog = h("dialog", { className: "conflict", "aria-labelledby": "conflict-title" });
  /** @type {(text: string, run: () => void, className?: string) => unknown} */
  const button = (text, run, className = "") =>
    html`<button type="button" class=${className} @click=${run}>${text}</button>`;
  /** @type {{ before: number, language: Language } | "theirs" | null} */
  let outcome = null;
  /** Apply the choice; show the error and keep the dialog open if that fails. */
  const pick = (/** @type {() => Promise<Language>} */ made) => async () => {
    try {
      outcome = { before: theirs.revision, language: await made() };
      dialog.close();
    } catch (error) {
      draw(
        error.status === 412
          ? "The language was changed once more. Close this, and save again."
          : error.message,
      );
    }
  };
  const onTop = () => change(theirs);
  const instead = async () => change(await api.languages.revert(theirs, from.revision));
  const keepTheirs = () => {
    outcome = "theirs";
    dialog.close();
  };
  /** @param {string} problem */
  const draw = (problem) =>
    render(
      html`<h2 id="conflict-title">Changed in two places</h2>
        <p class="dim">
          Somebody else, or another tab of yours, saved a change of ${from.name} while you made one,
          both from revision ${from.revision}. Theirs stays in the history whatever you pick.
        </p>
        <div class="conflict-versions">
          ${version(
            "Theirs, saved",
            [...deeds, ...theirWords],
            theirGestures,
            button("Keep theirs", keepTheirs),
          )}${version(
            "Yours, not saved yet",
            [title, ...changedTexts(mine, from)],
            diffGestures(mine, from),
            button("Keep yours", pick(instead)),
          )}
        </div>
        <p class="field-problem" role="alert" ?hidden=${!problem}>${problem}</p>
        <div class="dialog-actions">
          ${button("Decide later", () => dialog.close())}${button(
            "Keep both: yours on top of theirs",
            pick(onTop),
            "primary",
          )}
        </div>`,
      dialog,
    );
  draw("");
  document.body.append(dialog);
  dialog.showModal();
  await new Promise((resolve) => {
    dialog.onclose = resolve;
  });
  dialog.remove();
  if (outcome === "theirs") throw cancelled();
  if (outcome === null) throw undecided(doing);
  return outcome;
}
