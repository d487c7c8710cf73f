// The feedback to a diver about the last take.

import { h } from "../core/dom.js";
import { askWhich, moment } from "../core/format.js";

/** @import { PracticeAnswer } from "../core/types.d.ts" */

/**
 * The feedback: whether the take was right, and what to change.
 *
 * @param {PracticeAnswer} answer
 */
export function feedback({ take, sentence, lesson, notes }) {
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
    lesson
      ? h(
          "p",
          { className: "lesson" },
          h("b", {}, "Show it again: "),
          `in this take ${lesson.words}${lesson.start === null ? "" : ` (from ${moment(lesson.start)})`}.`,
        )
      : null,
    ...notes.map((text) => h("p", { className: "dim" }, text)),
  ].filter((each) => each !== null);
}
