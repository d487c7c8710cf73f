// The dialog that lists all keys; `?` opens it.

import { elementOf, html, render } from "../templates.js";
import { closeDialog, showDialog } from "./dialogs.js";
import { byId } from "./dom.js";
import { bind, bindings } from "./key-bindings.js";

/** @import { KeyListActions } from "./types.d.ts" */

/** @param {string} combination */
const keyCaps = (combination) => combination.split("+").map((key) => html`<kbd>${key}</kbd>`);

/** The keys that are bound by now, grouped. */
const keys = () =>
  [...new Set(bindings().map((each) => each.group))].map(
    (group) =>
      html`<section>
        <h3>${group}</h3>
        <dl>
          ${bindings()
            .filter((each) => each.group === group)
            .map(
              (each) =>
                html`<div>
                  <dt>${keyCaps(each.keys[0])}</dt>
                  <dd>${each.text}</dd>
                </div>`,
            )}
        </dl>
      </section>`,
  );

/**
 * Show all keys: first those bound so far, then those of views that have yet to be loaded.
 *
 * @param {KeyListActions} actions
 */
function showKeys({ loadAll, startTour, showExample }) {
  /** @type {(text: string, run: () => void) => unknown} */
  const button = (text, run) => {
    const leave = () => {
      closeDialog();
      run();
    };
    return html`<button type="button" @click=${leave}>${text}</button>`;
  };
  const content = elementOf(
    html`<div class="key-list">
      <h2 id="dialog-title">Keys</h2>
      <div class="key-groups"></div>
      <div class="dialog-actions">
        ${button("Tour", startTour)}${button("Example", showExample)}
        <button type="button" class="primary" autofocus @click=${closeDialog}>Close</button>
      </div>
    </div>`,
  );
  const list = /** @type {HTMLElement} */ (content.querySelector(".key-groups"));
  const draw = () => render(keys(), list);
  draw();
  loadAll().then(draw);
  showDialog(content);
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
