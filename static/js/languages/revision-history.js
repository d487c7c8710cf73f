// A language's history: its revisions with names, and two of them side by side.

import * as api from "../core/api.js";
import { ago, dateAndTime } from "../core/format.js";
import { currentLanguage, follow, state, update } from "../core/state.js";
import { attempt } from "../core/toasts.js";
import { address, here } from "../core/views.js";
import { buttonOf, html, iconOf, nothing, optionsOf, render, repeat } from "../templates.js";
import { comparison } from "./revision-diff.js";
import { editAndShow } from "./revision-edit.js";

/** @import { Revision, RevisionDiff, State } from "../core/types.d.ts" */

/** @type {Revision[]} */
let revisions = []; // of `of`, newest first
/** @type {string | null} */
let of = null;
/** @type {{ key: string, diff: RevisionDiff | null }} */
let compared = { key: "", diff: null };

const shown = () =>
  state.view === "languages" &&
  state.panel === "history" &&
  state.gestures !== null &&
  state.gestures.id === state.language;
/** @param {number} number */
const before = (number) => revisions.find((each) => each.revision < number)?.revision ?? null;

/**
 * Show the diff of a revision against the one before it, or an empty language.
 *
 * @param {number} number
 */
const select = (number) => update({ newer: number, older: before(number) });

/** @param {Revision} revision */
const goBack = ({ revision }) =>
  editAndShow(
    "Going back",
    `Going back to revision ${revision}`,
    (language) => api.languages.revert(language, revision),
    () => [`Went back to revision ${revision}`, "The newer ones stay in the history."],
  );

/** @param {Revision} row */
function item(row) {
  const newest = row === revisions[0];
  const chosen = row.revision === state.newer;
  const facts = [newest ? "newest" : null, ago(row.created), row.author].filter(Boolean);
  return html`<li class="revision ${chosen ? "chosen" : ""}">
    <button
      type="button"
      class="revision-open"
      aria-pressed=${chosen}
      @click=${() => select(row.revision)}
    >
      <span class="revision-number">${row.revision}</span>
      <span class="revision-text"
        ><b>${row.change}</b
        ><span class="dim" title=${dateAndTime(row.created)}>${facts.join(" \u00b7 ")}</span></span
      >
    </button>
    ${
      newest
        ? nothing
        : buttonOf("Go back", () => goBack(row), {
            look: "quiet",
            writes: true,
            label: `Go back to revision ${row.revision}`,
          })
    }
  </li>`;
}

/**
 * The choice of one of the two revisions that are compared.
 *
 * @param {"older" | "newer"} which
 * @param {(number | null)[]} numbers
 */
function picker(which, numbers) {
  const pick = (/** @type {any} */ { target: { value } }) =>
    update({ [which]: value ? Number(value) : null });
  /** @type {[string, string][]} */
  const options = numbers.map((number) => [
    String(number ?? ""),
    number === null ? "nothing" : `revision ${number}`,
  ]);
  return html`<label for=${which}>${which === "older" ? "from" : "to"}</label
    ><select id=${which} @change=${pick}>
      ${optionsOf(options, String(state[which] ?? ""))}
    </select>`;
}

function page() {
  const closed = { panel: null, older: null, newer: null };
  const numbers = revisions.map((row) => row.revision);
  return html`<div class="page-head">
      <a
        href=${address("languages", closed)}
        class="button quiet back"
        @click=${here(() => update(closed))}
        >${iconOf("chevron")}All languages</a
      >
      <h1>${currentLanguage().name}</h1>
    </div>
    <div class="history-columns">
      <section aria-label="History">
        <h2>History</h2>
        <ol class="revisions" aria-label="Revisions">
          ${repeat(revisions, ({ revision }) => revision, item)}
        </ol>
      </section>
      <section aria-label="Comparison">
        <div class="compare-head">
          <h2>Compare</h2>
          ${picker("older", [...numbers, null])}${picker("newer", numbers)}
        </div>
        <div class="comparison" aria-live="polite">
          ${compared.diff ? comparison(compared.diff) : nothing}
        </div>
      </section>
    </div>`;
}

/** Load the history of the language on display when it is another, or has a new revision. */
async function load() {
  const { id, revision } = currentLanguage();
  const [head, earlier] = [revisions[0]?.revision, of];
  if (of !== id || head !== revision) {
    const loaded = await attempt("Loading the history", () => api.languages.revisions(id));
    if (!loaded || state.gestures?.id !== id) return;
    [revisions, of] = [loaded, id];
  }
  const another = earlier !== null && earlier !== id;
  const outgrown = earlier === id && state.newer === head && head !== revision;
  if (another || outgrown || !areKnown(state)) select(revisions[0].revision);
}

/**
 * Whether both revisions of a diff are in the history.
 *
 * @param {Pick<State, "newer" | "older">} state
 */
function areKnown({ newer, older }) {
  const numbers = [null, ...revisions.map(({ revision }) => revision)];
  return newer !== null && numbers.includes(newer) && numbers.includes(older);
}

/** @param {HTMLElement} panel */
async function draw(panel) {
  render(page(), panel);
  const key = `${of} ${state.older} ${state.newer}`;
  if (key === compared.key) return;
  compared.key = key;
  const diff = await attempt("Comparing", () =>
    api.languages.compare(of ?? "", state.older, state.newer ?? 0),
  );
  if (!diff || compared.key !== key) return;
  compared = { key, diff };
  render(page(), panel);
}

/**
 * Build the panel and keep it in step.
 *
 * @param {HTMLElement} panel
 */
export function openHistoryPanel(panel) {
  follow(["view", "panel", "gestures", "older", "newer"], async () => {
    if (!shown()) return;
    await load();
    if (shown() && of === currentLanguage().id) draw(panel);
  });
}
