// The feedback to a diver about the last take.

import { askWhich } from "../core/format.js";
import { html } from "../templates.js";

/** @import { PracticeAnswer } from "../core/types.d.ts" */

/**
 * The feedback: whether the take was right, and what to change.
 *
 * @param {PracticeAnswer} answer
 */
export function feedback({ take, sentence, notes }) {
  const look = take.right ? "right" : take.pair ? "asked" : "wrong";
  const heads = {
    right: "\u2713 Right: ",
    asked: take.pair ? `? ${askWhich(take.pair)} ` : "",
    wrong: "\u2260 Not yet: ",
  };
  return html`<p class="practice-${look}">
      <b>${heads[look]}</b>${take.right ? take.expected : sentence}
    </p>
    ${notes.map((text) => html`<p class="dim">${text}</p>`)}`;
}
