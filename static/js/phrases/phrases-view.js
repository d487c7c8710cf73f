// The phrases view: a form for the phrases, their ambiguities, and a trial by clicked gestures.

import { byId, h } from "../core/dom.js";
import { plural } from "../core/format.js";
import { follow, state, update } from "../core/state.js";
import { showDone } from "../core/undo.js";
import { go } from "../core/views.js";
import { buttonOf, html, nothing } from "../templates.js";
import { addButton, redraw } from "./form-fields.js";
import { free, withPhrase } from "./grammar-edits.js";
import { followRefusals, grammar, labels, save } from "./grammar-store.js";
import { framePanel } from "./message-frame.js";
import { phraseCard } from "./phrase-card.js";
import { ambiguities, followTrial, found, show, trialPanel } from "./phrase-trial.js";
import { slotTypesPanel } from "./slot-types.js";

/** @import { State } from "../core/types.d.ts" */

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
function findings() {
  const list = found()?.ambiguities ?? [];
  if (!list.length) return nothing;
  return html`<ul class="findings" aria-label="Ambiguities">
    ${list.map(
      ({ message, gestures }, index) =>
        html`<li class="finding error">
          <span class="mark" aria-hidden="true">!</span>
          <div class="finding-text"><p>${message}</p></div>
          ${buttonOf("Try", () => show(gestures), {
            label: `Try: ${gestures.join(", ")}`,
            id: `ambiguity-${index}-try`,
          })}
        </li>`,
    )}
  </ul>`;
}

function verdict() {
  const view = found();
  if (!view || !grammar().phrases.length) return nothing;
  const count = view.ambiguities.length;
  return html`<p class="verdict ${count ? "unwell" : "well"}" role="status">
    <span class="mark" aria-hidden="true">${count ? "!" : "\u2713"}</span
    ><b>${count ? ambiguities(count) : "Nothing ambiguous"}</b>
  </p>`;
}

const beginning = () =>
  html`<div class="phrases-empty">
    <p><b>No phrases yet</b></p>
    <p class="dim">
      Without phrases every gesture is a message of its own. A phrase is a sequence of gestures with
      one meaning: “photo, 3 times”. Gestures of your choice open and close it, so that background
      motion is not obeyed.
    </p>
    ${addButton("add-phrase", "Add the first phrase", addPhrase, "primary")}
  </div>`;

const noGestures = () =>
  html`<div class="phrases-empty">
    <p><b>${state.gestures ? "No gestures to make phrases of" : "No language yet"}</b></p>
    <p class="dim">Save a gesture from a clip first.</p>
    <button type="button" class="primary" @click=${() => go("studio")}>To the clips</button>
  </div>`;

function list() {
  const { phrases } = grammar();
  return html`<section class="phrase-section" aria-labelledby="phrases-title">
    <div class="panel-head">
      <h2 id="phrases-title">Phrases</h2>
      <small class="dim">${plural(phrases.length, "phrase")}</small>
      <span class="spacer"></span>
      ${addButton("add-phrase", "New phrase", addPhrase, "primary")}
    </div>
    <ul class="phrase-list" aria-label="Phrases">
      ${phrases.map(phraseCard)}
    </ul>
  </section>`;
}

const form = () =>
  html`${findings()}${list()}${framePanel()}${slotTypesPanel()}
    <div>
      <button type="button" class="quiet" id="take-out" data-writes @click=${takeOut}>
        Take all phrases out
      </button>
    </div>`;

/** @param {State} state */
function columns({ gestures }) {
  if (!gestures?.gestures.length) return noGestures();
  const some = grammar().phrases.length > 0;
  const first = () => [beginning(), gestures.grammar ? slotTypesPanel() : nothing];
  return html`<div class="phrase-columns ${some ? "" : "alone"}">
    <div class="phrase-editor">${some ? form() : first()}</div>
    ${some ? trialPanel() : nothing}
  </div>`;
}

/**
 * Build the view.
 *
 * @param {HTMLElement} section
 */
export function open(section) {
  const page = h("div", { className: "phrases-page" });
  section.append(page);
  const draw = () => {
    const { gestures, loaded, view } = state;
    if (view !== "phrases" || (!gestures && !loaded)) return;
    redraw(
      page,
      html`<div class="page-head">
          <h1>${gestures ? `Phrases of ${gestures.name}` : "Phrases"}</h1>
          <span class="spacer"></span>
          <div class="verdict-place">${gestures?.gestures.length ? verdict() : nothing}</div>
        </div>
        ${columns(state)}`,
    );
  };
  followTrial(draw);
  followRefusals(draw);
  follow(["view", "gestures", "phrase", "loaded", "shown", "paused"], draw);
}
