// The button beside a choice of clips that loads older ones into it.

import { disableDuring, h } from "../core/dom.js";
import { plural } from "../core/format.js";
import { follow, state } from "../core/state.js";
import { loadOlder } from "./clip-pages.js";

/** @param {HTMLElement} button */
function draw(button) {
  const { last, older } = state.library;
  button.hidden = !last;
  button.textContent = `Load more of ${plural(older, "older clip")}`;
}

/**
 * Make the button; it is hidden once all clips are loaded. `loaded` is called after more clips have
 * come, for a choice that does not follow the state by itself.
 *
 * @param {() => void} [loaded]
 */
export function olderClipsButton(loaded = () => {}) {
  const button = h("button", { type: "button", className: "link older-clips" });
  button.onclick = async () => {
    await disableDuring(button, loadOlder);
    loaded();
  };
  draw(button);
  return button;
}

follow(["library"], () => {
  for (const button of document.querySelectorAll(".older-clips"))
    draw(/** @type {HTMLElement} */ (button));
});
