// Leaving with a draft that is not saved: it can be kept for later, or dropped.

import { closeDialog, showDialog } from "../core/dialogs.js";
import { elementOf, html } from "../templates.js";
import { forget } from "./gesture-draft.js";

/**
 * Ask whether to leave the editor; resolves to the answer.
 *
 * @returns {Promise<boolean>}
 */
export function mayLeave() {
  let leaves = false;
  const leave = () => {
    leaves = true;
    closeDialog();
  };
  const drop = () => {
    forget();
    leave();
  };
  const question = html`<div class="leaving">
    <h2 id="dialog-title">Leave without saving?</h2>
    <p class="dim">
      The gesture was changed and not saved. A draft is kept in this browser and comes back when the
      gesture is opened again.
    </p>
    <div class="dialog-actions">
      <button type="button" @click=${closeDialog}>Go on editing</button>
      <button type="button" @click=${drop}>Discard</button>
      <button type="button" class="primary" @click=${leave}>Keep the draft</button>
    </div>
  </div>`;
  return new Promise((resolve) => {
    showDialog(elementOf(question), () => resolve(leaves));
  });
}
