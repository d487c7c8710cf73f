// A language's history: its revisions with names, and two of them side by side.

import * as api from "../core/api.js";
import { h, icon, reconcile, WRITES } from "../core/dom.js";
import { ago, dateAndTime } from "../core/format.js";
import { currentLanguage, follow, state, update } from "../core/state.js";
import { attempt, complain } from "../core/toasts.js";
import { showDone } from "../core/undo.js";
import { address, here } from "../core/views.js";
import { drawComparison } from "./revision-diff.js";
import { edit } from "./revision-edit.js";

/** @import { Revision, State } from "../core/types.d.ts" */

/** @type {Revision[]} */
let revisions = []; // of `of`, newest first
/** @type {string | null} */
let of = null;

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
async function goBack({ revision }) {
  try {
    await edit("Going back", `Going back to revision ${revision}`, (language) =>
      api.languages.revert(language, revision),
    );
    showDone(`Went back to revision ${revision}`, "The newer ones stay in the history.");
  } catch (error) {
    complain(error, "Going back");
  }
}

/**
 * @param {Revision} row
 * @param {HTMLElement | undefined} element
 */
function drawRevision(row, element) {
  const newest = row === revisions[0];
  const chosen = row.revision === state.newer;
  const signature = JSON.stringify([row, newest, chosen, ago(row.created)]);
  if (element?.dataset.signature === signature) return element;
  const item = element ?? h("li", { className: "revision" });
  const focused = element?.contains(document.activeElement);
  item.dataset.signature = signature;
  item.classList.toggle("chosen", chosen);
  const what = h(
    "button",
    {
      type: "button",
      className: "revision-open",
      "aria-pressed": String(chosen),
      onclick: () => select(row.revision),
    },
    h("span", { className: "revision-number" }, `${row.revision}`),
    h(
      "span",
      { className: "revision-text" },
      h("b", {}, row.change),
      h(
        "span",
        { className: "dim", title: dateAndTime(row.created) },
        [newest ? "newest" : null, ago(row.created), row.author].filter(Boolean).join(" \u00b7 "),
      ),
    ),
  );
  item.replaceChildren(
    what,
    newest
      ? ""
      : h(
          "button",
          {
            type: "button",
            className: "quiet",
            ...WRITES,
            "aria-label": `Go back to revision ${row.revision}`,
            onclick: () => goBack(row),
          },
          "Go back",
        ),
  );
  if (focused) what.focus();
  return item;
}

/**
 * @param {HTMLSelectElement} picker
 * @param {(number | null)[]} numbers
 * @param {number | null} value
 */
function options(picker, numbers, value) {
  picker.replaceChildren(
    ...numbers.map((number) =>
      h("option", { value: number ?? "" }, number === null ? "nothing" : `revision ${number}`),
    ),
  );
  picker.value = String(value ?? "");
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

/**
 * Build the panel and keep it in step.
 *
 * @param {HTMLElement} panel
 */
export function openHistoryPanel(panel) {
  const list = h("ol", { className: "revisions", "aria-label": "Revisions" });
  const title = h("h1", {});
  const older = h("select", {
    id: "older",
    onchange: () => update({ older: older.value ? Number(older.value) : null }),
  });
  const newer = h("select", {
    id: "newer",
    onchange: () => update({ newer: Number(newer.value) }),
  });
  const result = h("div", { className: "comparison", "aria-live": "polite" });
  panel.append(
    h(
      "div",
      { className: "page-head" },
      h(
        "a",
        {
          href: address("languages", { panel: null, older: null, newer: null }),
          className: "button quiet back",
          onclick: here(() => update({ panel: null, older: null, newer: null })),
        },
        icon("chevron"),
        "All languages",
      ),
      title,
    ),
    h(
      "div",
      { className: "history-columns" },
      h("section", { "aria-label": "History" }, h("h2", {}, "History"), list),
      h(
        "section",
        { "aria-label": "Comparison" },
        h(
          "div",
          { className: "compare-head" },
          h("h2", {}, "Compare"),
          h("label", { for: "older" }, "from"),
          older,
          h("label", { for: "newer" }, "to"),
          newer,
        ),
        result,
      ),
    ),
  );

  let drawn = "";
  const draw = async () => {
    title.textContent = currentLanguage().name;
    reconcile(list, revisions, (row) => row.revision, drawRevision);
    const numbers = revisions.map((row) => row.revision);
    options(newer, numbers, state.newer);
    options(older, [...numbers, null], state.older);
    const wanted = `${of} ${state.older} ${state.newer}`;
    if (wanted === drawn) return;
    drawn = wanted;
    const comparison = await attempt("Comparing", () =>
      api.languages.compare(of ?? "", state.older, state.newer ?? 0),
    );
    if (comparison && drawn === wanted) drawComparison(result, comparison);
  };
  follow(["view", "panel", "gestures", "older", "newer"], async () => {
    if (!shown()) return;
    await load();
    if (shown() && of === currentLanguage().id) draw();
  });
}
