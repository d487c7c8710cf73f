// Leaving with a draft that is not saved: it can be kept for later, or dropped.

import { byId, h } from "../core/dom.js";
import { forget } from "./gesture-draft.js";

/**
 * Ask whether to leave the editor; resolves to the answer.
 *
 * @returns {Promise<boolean>}
 */
export function mayLeave() {
  const dialog = byId("dialog");
  return new Promise((resolve) => {
    let leaves = false;
    /**
     * @param {string} text
     * @param {() => void} run
     * @param {string} [className]
     */
    const pick = (text, run, className = "") =>
      h(
        "button",
        {
          type: "button",
          className,
          onclick: () => {
            run();
            dialog.close();
          },
        },
        text,
      );
    dialog.replaceChildren(
      h(
        "div",
        { className: "leaving" },
        h("h2", { id: "dialog-title" }, "Leave without saving?"),
        h(
          "p",
          { className: "dim" },
          "The gesture was changed and not saved. A draft is kept in this browser and comes back when the gesture is opened again.",
        ),
        h(
          "div",
          { className: "dialog-actions" },
          pick("Go on editing", () => {}),
          pick("Discard", () => {
            forget();
            leaves = true;
          }),
          pick(
            "Keep the draft",
            () => {
              leaves = true;
            },
            "primary",
          ),
        ),
      ),
    );
    dialog.setAttribute("aria-labelledby", "dialog-title");
    dialog.onclose = () => resolve(leaves);
    dialog.showModal();
  });
}
