// The page of an invited person: what the invitation is, and who shows.

import { browserStore } from "../core/browser-store.js";
import { html, limited, nothing, render } from "../templates.js";
import { capital, showGestures } from "./gesture-takes.js";
import { findInvited } from "./take-sending.js";

/** @import { Invited } from "../core/types.d.ts" */

const LONGEST_NAME = 80; // `MAX_DIVER_LENGTH` in gestures/demonstration.py

const root = /** @type {HTMLElement} */ (document.getElementById("invitation"));

/**
 * @param {string} title
 * @param {string} text
 * @param {unknown} [more]
 */
const notice = (title, text, more = nothing) =>
  render(
    html`<div class="notice" role="status">
      <h1>${title}</h1>
      <p>${text}</p>
      ${more}
    </div>`,
    root,
  );

/** @type {Record<string, string>} */
const TITLES = {
  invitation_unknown: "No invitation",
  invitation_closed: "Invitation closed",
};

async function open() {
  notice("One moment", "Asking for the gestures.");
  let invited;
  try {
    invited = await findInvited();
  } catch (error) {
    const title = TITLES[error.code] ?? error.title;
    const again = html`<button type="button" class="primary" @click=${open}>Try again</button>`;
    notice(title, capital(error.message), again);
    return;
  }
  const { kept } = memoryOf(invited);
  if (invited.takes_left || Object.keys(kept.takes).length) askName(invited);
  else
    notice(
      "This invitation takes nothing more",
      "All its takes are used. Ask whoever sent it for a new one.",
    );
}

/**
 * What this browser knows of the invitation: a phone may drop the page while its camera is open.
 *
 * @param {Invited} invited
 */
function memoryOf({ id }) {
  const key = `osg-studio.invitation.${id}`;
  /** @type {{ name: string, takes: Record<string, string> }} */
  const kept = browserStore.read(key) ?? { name: "", takes: {} };
  return { kept, write: () => browserStore.write(key, kept) };
}

/** @param {Invited} invited */
function askName(invited) {
  const memory = memoryOf(invited);
  const field = () => /** @type {HTMLInputElement} */ (document.getElementById("name"));
  const begin = (/** @type {SubmitEvent} */ event) => {
    event.preventDefault();
    const name = field().value.trim();
    if (!name) return field().focus();
    if (name !== memory.kept.name) memory.kept.takes = {};
    memory.kept.name = name;
    memory.write();
    return showGestures(root, invited, memory);
  };
  const count = invited.gestures.length;
  render(
    html`<form class="notice" @submit=${begin}>
      <h1>Show the gestures of ${invited.language}</h1>
      <p>
        ${count === 1 ? "One gesture" : `${count} gestures`}, each once. So the robot learns how
        other people show them.
      </p>
      <label for="name">Your name, or any other word for you</label>
      <input
        type="text"
        id="name"
        .value=${memory.kept.name}
        autocomplete="nickname"
        required
        ${limited(LONGEST_NAME)}
      />
      <button type="submit" class="primary">Begin</button>
      <p class="dim">
        Whoever invited you keeps your clips under this name. Nobody else who has the link sees
        them.
      </p>
    </form>`,
    root,
  );
  field().focus();
}

root.replaceChildren(); // The note for browsers without JavaScript.
addEventListener("hashchange", open);
open();
