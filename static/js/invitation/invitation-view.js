// The page of an invited person: what the invitation is, and who shows.

import { browserStore } from "../core/browser-store.js";
import { h } from "../core/dom.js";
import { limit } from "../core/text-limit.js";
import { capital, showGestures } from "./gesture-takes.js";
import { findInvited } from "./take-sending.js";

/** @import { Invited } from "../core/types.d.ts" */

const LONGEST_NAME = 80; // `MAX_DIVER_LENGTH` in gestures/demonstration.py

const root = /** @type {HTMLElement} */ (document.getElementById("invitation"));

/**
 * @param {string} title
 * @param {string} text
 * @param {...Node} more
 */
const notice = (title, text, ...more) =>
  root.replaceChildren(
    h(
      "div",
      { className: "notice", role: "status" },
      h("h1", {}, title),
      h("p", {}, text),
      ...more,
    ),
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
    const again = h("button", { type: "button", className: "primary", onclick: open }, "Try again");
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
  const input = limit(
    h("input", {
      type: "text",
      id: "name",
      value: memory.kept.name,
      autocomplete: "nickname",
      required: true,
    }),
    LONGEST_NAME,
  );
  const count = invited.gestures.length;
  const form = h(
    "form",
    { className: "notice" },
    h("h1", {}, `Show the gestures of ${invited.language}`),
    h(
      "p",
      {},
      `${count === 1 ? "One gesture" : `${count} gestures`}, each once. So the robot learns how other people show them.`,
    ),
    h("label", { for: "name" }, "Your name, or any other word for you"),
    input,
    h("button", { type: "submit", className: "primary" }, "Begin"),
    h(
      "p",
      { className: "dim" },
      "Whoever invited you keeps your clips under this name. Nobody else who has the link sees them.",
    ),
  );
  form.onsubmit = (event) => {
    event.preventDefault();
    const name = input.value.trim();
    if (!name) return input.focus();
    if (name !== memory.kept.name) memory.kept.takes = {};
    memory.kept.name = name;
    memory.write();
    return showGestures(root, invited, memory);
  };
  root.replaceChildren(form);
  input.focus();
}

addEventListener("hashchange", open);
open();
