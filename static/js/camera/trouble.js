// What is wrong with a camera or its connection, over its picture, with a way out.

import { h } from "../core/dom.js";

/** @import { Trouble } from "./live-messages.d.ts" */

/**
 * Show what is wrong in a box; null hides it.
 *
 * @param {HTMLElement} box
 * @param {Trouble | null} trouble
 * @param {() => unknown} again Called by the button that tries again.
 */
export function drawTrouble(box, trouble, again) {
  box.hidden = !trouble;
  if (trouble)
    box.replaceChildren(
      h("b", {}, trouble.title),
      h("p", {}, trouble.text),
      h("button", { type: "button", onclick: again }, "Try again"),
    );
}
