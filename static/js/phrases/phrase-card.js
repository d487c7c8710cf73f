// The card of a phrase: closed as a sequence, open as a form.

import { state, update } from "../core/state.js";
import { toast } from "../core/toasts.js";
import { showDone } from "../core/undo.js";
import { read, written } from "../languages/robot-command.js";
import { buttonOf, html, iconOf, nothing } from "../templates.js";
import { textField, tool } from "./form-fields.js";
import { inPhrase, rememberName, slotsOf } from "./grammar-edits.js";
import { save } from "./grammar-store.js";
import { addButtons, partList } from "./phrase-parts.js";
import { sequence } from "./phrase-sequence.js";
import { ambiguities, found, showExample } from "./phrase-trial.js";

/** @import { Phrase } from "../core/types.d.ts" */

/**
 * @param {Phrase} phrase
 * @param {string} title
 * @param {Partial<Phrase>} change
 */
const put = (phrase, title, change) =>
  save(
    title,
    inPhrase(phrase.name, (whole) => ({ ...whole, ...change })),
  );

/**
 * @param {Phrase} phrase
 * @param {string} text
 */
async function rename(phrase, text) {
  const name = text.trim();
  const kept = await put(phrase, `Rename to ${name}`, { name });
  if (kept) {
    rememberName(phrase.name, name);
    update({ phrase: name });
  }
  return kept;
}

/** @param {Phrase} phrase */
async function remove(phrase) {
  const title = `Deletion of ${phrase.name}`;
  if (
    !(await save(title, (base) => ({
      ...base,
      phrases: base.phrases.filter(({ name }) => name !== phrase.name),
    })))
  )
    return;
  if (state.phrase === phrase.name) update({ phrase: null });
  showDone("Phrase deleted", phrase.name);
}

/**
 * @param {Phrase} phrase
 * @param {string} text
 */
function command(phrase, text) {
  const { command: value, problem } = read(text);
  if (!problem) return put(phrase, "Command", { command: value });
  toast("The command is not saved", problem, { kind: "error" });
  return false;
}

/**
 * @param {Phrase} phrase
 * @param {number} place
 */
function form(phrase, place) {
  const slots = slotsOf(phrase).map((slot) => `{${slot.slot}}`);
  const hint = slots.length
    ? `${slots.join(" and ")} ${slots.length > 1 ? "stand for the values" : "stands for the value"} shown. In the spoken text, put what is left out with a slot in [ ].`
    : "Add a slot for a value of the command: how often, how deep or which way.";
  const id = `phrase-${place}`;
  return html`<div class="phrase-form">
    ${textField({
      id: `${id}-name`,
      label: "Name",
      value: phrase.name,
      most: 80,
      commit: (text) => rename(phrase, text),
    })}
    <div class="phrase-parts">
      <h3>What is shown</h3>
      ${partList(phrase, [], phrase.parts)}${addButtons(phrase)}
    </div>
    ${textField({
      id: `${id}-says`,
      label: "Spoken back",
      value: phrase.says,
      placeholder: "the name and the values",
      most: 2000,
      commit: (text) => put(phrase, "Spoken text", { says: text.trim() }),
    })}${textField({
      id: `${id}-command`,
      label: "Command for the robot",
      value: written(phrase.command),
      placeholder: "words, or a JSON object",
      multiline: true,
      commit: (text) => command(phrase, text),
    })}
    <p class="dim">${hint}</p>
  </div>`;
}

/** @param {number} count */
const doubt = (count) =>
  html`<span class="doubt"
    ><span class="mark" aria-hidden="true">!</span>${ambiguities(count)}</span
  >`;

/**
 * Draw a phrase.
 *
 * @param {Phrase} phrase
 * @param {number} place
 */
export function phraseCard(phrase, place) {
  const open = state.phrase === phrase.name;
  const doubts = found()?.ambiguities.filter(({ phrases }) => phrases.includes(phrase.name)) ?? [];
  const id = `phrase-${place}`;
  return html`<li class="phrase ${open ? "open" : ""}">
    <div class="phrase-head">
      <button
        type="button"
        class="phrase-open"
        id="${id}-open"
        aria-expanded=${open}
        @click=${() => update({ phrase: open ? null : phrase.name })}
      >
        ${iconOf("chevron")}<b>${phrase.name}</b></button
      >${sequence(phrase)}${doubts.length ? doubt(doubts.length) : nothing}${buttonOf(
        "Try",
        () => showExample(phrase.name),
        { label: `Try ${phrase.name}`, id: `${id}-try` },
      )}${tool(`${id}-remove`, "trash", `Delete ${phrase.name}`, () => remove(phrase))}
    </div>
    ${open ? form(phrase, place) : nothing}
  </li>`;
}
