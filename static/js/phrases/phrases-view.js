// The phrases view: a form for the phrases, their ambiguities, and a trial by clicked gestures.

import { byId, h, icon, WRITES } from "../core/dom.js";
import { plural } from "../core/format.js";
import { follow, state, update } from "../core/state.js";
import { showDone } from "../core/undo.js";
import { go } from "../core/views.js";
import { redraw } from "./form-fields.js";
import { free, withPhrase } from "./grammar-edits.js";
import { followRefusals, grammar, labels, save } from "./grammar-store.js";
import { framePanel } from "./message-frame.js";
import { phraseCard } from "./phrase-card.js";
import { followFound, found, show, trialPanel } from "./phrase-trial.js";
import { slotTypesPanel } from "./slot-types.js";

/** @import { Grammar } from "../core/types.d.ts" */

async function addPhrase() {
  const name = free(
    "phrase",
    grammar().phrases.map((each) => each.name),
  );
  if (await save(`New ${name}`, (base) => withPhrase(base, name, labels()))) {
    update({ phrase: name });
    byId(`phrase-${grammar().phrases.length - 1}-name`)?.select();
  }
}

async function takeOut() {
  if (!(await save("Phrases taken out", () => null))) return;
  update({ phrase: null, shown: null, paused: null });
  showDone("Phrases taken out", "Every gesture is a message of its own.");
}

/** The ambiguities, each with a message that shows it. */
function ambiguities() {
  const list = found()?.ambiguities ?? [];
  if (!list.length) return null;
  return h(
    "ul",
    { className: "findings", "aria-label": "Ambiguities" },
    list.map(({ message, gestures }, index) =>
      h(
        "li",
        { className: "finding error" },
        h("span", { className: "mark", "aria-hidden": "true" }, "!"),
        h("div", { className: "finding-text" }, h("p", {}, message)),
        h(
          "button",
          {
            type: "button",
            id: `ambiguity-${index}-try`,
            "aria-label": `Try: ${gestures.join(", ")}`,
            onclick: () => show(gestures),
          },
          "Try",
        ),
      ),
    ),
  );
}

function verdict() {
  const view = found();
  if (!view || !grammar().phrases.length) return null;
  const count = view.ambiguities.length;
  return h(
    "p",
    { className: `verdict ${count ? "unwell" : "well"}`, role: "status" },
    h("span", { className: "mark", "aria-hidden": "true" }, count ? "!" : "\u2713"),
    h(
      "b",
      {},
      count ? `${count} ${count === 1 ? "ambiguity" : "ambiguities"}` : "Nothing ambiguous",
    ),
  );
}

function beginning() {
  return h(
    "div",
    { className: "phrases-empty" },
    h("p", {}, h("b", {}, "No phrases yet")),
    h(
      "p",
      { className: "dim" },
      "Without phrases every gesture is a message of its own. A phrase is a sequence of gestures with one meaning: \u201cphoto, 3 times\u201d. Gestures of your choice open and close it, so that background motion is not obeyed.",
    ),
    h(
      "button",
      { type: "button", className: "primary", id: "add-phrase", ...WRITES, onclick: addPhrase },
      icon("plus"),
      "Add the first phrase",
    ),
  );
}

function noGestures() {
  return h(
    "div",
    { className: "phrases-empty" },
    h("p", {}, h("b", {}, state.gestures ? "No gestures to make phrases of" : "No language yet")),
    h("p", { className: "dim" }, "Save a gesture from a clip first."),
    h(
      "button",
      { type: "button", className: "primary", onclick: () => go("studio") },
      "To the clips",
    ),
  );
}

function list() {
  const { phrases } = grammar();
  return h(
    "section",
    { className: "phrase-section", "aria-labelledby": "phrases-title" },
    h(
      "div",
      { className: "panel-head" },
      h("h2", { id: "phrases-title" }, "Phrases"),
      h("small", { className: "dim" }, plural(phrases.length, "phrase")),
      h("span", { className: "spacer" }),
      h(
        "button",
        { type: "button", className: "primary", id: "add-phrase", ...WRITES, onclick: addPhrase },
        icon("plus"),
        "New phrase",
      ),
    ),
    h("ul", { className: "phrase-list", "aria-label": "Phrases" }, phrases.map(phraseCard)),
  );
}

/** All that the view shows, as one key. */
function shownKey() {
  const { gestures, phrase } = state;
  const { id, name, grammar: kept } = gestures ?? {};
  return JSON.stringify([id, name, labels(), kept, phrase, found()?.ambiguities]);
}

/**
 * Build the view.
 *
 * @param {HTMLElement} section
 */
export function open(section) {
  const title = h("h1");
  const says = h("div", { className: "verdict-place" });
  const form = h("div", { className: "phrase-editor" });
  const trial = trialPanel();
  const columns = h("div", { className: "phrase-columns" }, form, trial);
  const none = h("div");
  let drawn = "";
  /** @param {Grammar | null | undefined} kept */
  const drawForm = (kept) => {
    trial.hidden = !grammar().phrases.length;
    columns.classList.toggle("alone", trial.hidden);
    if (trial.hidden) redraw(form, beginning(), kept ? slotTypesPanel() : null);
    else {
      redraw(
        form,
        ambiguities(),
        list(),
        framePanel(),
        slotTypesPanel(),
        h(
          "div",
          {},
          h(
            "button",
            { type: "button", className: "quiet", id: "take-out", ...WRITES, onclick: takeOut },
            "Take all phrases out",
          ),
        ),
      );
    }
  };
  const draw = () => {
    const { gestures, loaded, view } = state;
    if (view !== "phrases" || (!gestures && !loaded)) return;
    const now = shownKey();
    if (now === drawn) return; // a button being pressed stays in place
    drawn = now;
    title.textContent = gestures ? `Phrases of ${gestures.name}` : "Phrases";
    const able = Boolean(gestures?.gestures.length);
    columns.hidden = !able;
    none.hidden = able;
    none.replaceChildren(...(able ? [] : [noGestures()]));
    says.replaceChildren(...[able ? verdict() : null].filter((each) => each !== null));
    if (!able) return;
    drawForm(gestures?.grammar);
  };
  section.append(
    h(
      "div",
      { className: "phrases-page" },
      h("div", { className: "page-head" }, title, h("span", { className: "spacer" }), says),
      none,
      columns,
    ),
  );
  followFound(draw);
  followRefusals(() => {
    drawn = "";
    draw();
  });
  follow(["view", "gestures", "phrase", "loaded"], draw);
}
