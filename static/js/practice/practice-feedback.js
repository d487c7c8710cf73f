// The feedback to a diver about the last take.

import { h } from "../core/dom.js";
import { askWhich } from "../core/format.js";

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
  return [
    h(
      "p",
      { className: `practice-${look}` },
      h("b", {}, heads[look]),
      take.right ? take.expected : sentence,
    ),
    ...notes.map((text) => h("p", { className: "dim" }, text)),
  ].filter((each) => each !== null);
}
