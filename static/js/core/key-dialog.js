// The dialog that lists all keys; `?` opens it.

import { byId, h } from "./dom.js";
import { bind, bindings } from "./key-bindings.js";

/** @import { KeyListActions } from "./types.d.ts" */

/** @param {string} combination */
const keyCaps = (combination) => combination.split("+").map((key) => h("kbd", {}, key));

/**
 * Draw the keys that are bound by now, grouped.
 *
 * @param {HTMLElement} list
 */
function drawKeys(list) {
  const groups = [...new Set(bindings().map((each) => each.group))];
  list.replaceChildren(
    ...groups.map((group) =>
      h(
        "section",
        {},
        h("h3", {}, group),
        h(
          "dl",
          {},
          bindings()
            .filter((each) => each.group === group)
            .map((each) =>
              h("div", {}, h("dt", {}, keyCaps(each.keys[0])), h("dd", {}, each.text)),
            ),
        ),
      ),
    ),
  );
}

/**
 * Show all keys: first those bound so far, then those of views that have yet to be loaded.
 *
 * @param {KeyListActions} actions
 */
function showKeys({ loadAll, startTour, showExample }) {
  const dialog = byId("dialog");
  const list = h("div", { className: "key-groups" });
  drawKeys(list);
  loadAll().then(() => drawKeys(list));
  dialog.replaceChildren(
    h(
      "div",
      { className: "key-list" },
      h("h2", { id: "dialog-title" }, "Keys"),
      list,
      h(
        "div",
        { className: "dialog-actions" },
        h(
          "button",
          {
            type: "button",
            onclick: () => {
              dialog.close();
              startTour();
            },
          },
          "Tour",
        ),
        h(
          "button",
          {
            type: "button",
            onclick: () => {
              dialog.close();
              showExample();
            },
          },
          "Example",
        ),
        h(
          "button",
          { type: "button", className: "primary", autofocus: true, onclick: () => dialog.close() },
          "Close",
        ),
      ),
    ),
  );
  dialog.setAttribute("aria-labelledby", "dialog-title");
  dialog.onclose = null;
  dialog.showModal();
}

/**
 * Bind `?` and the button to the dialog. `loadAll()` loads the remaining modules that bind keys;
 * `startTour()` is called by the dialog's button "Tour".
 *
 * @param {KeyListActions} actions
 */
export function bindKeyList(actions) {
  const run = () => showKeys(actions);
  byId("keys").onclick = run;
  bind({ keys: ["?"], text: "Show all keys", group: "Everywhere", run });
}
