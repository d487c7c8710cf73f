// Invitations: other people add their takes to the language by a link or its QR code.

import * as api from "../core/api.js";
import { copy } from "../core/clipboard.js";
import { byId, h, WRITES } from "../core/dom.js";
import { ago, dateAndTime, plural } from "../core/format.js";
import { currentLanguage, follow, state } from "../core/state.js";
import { MAX_DEMONSTRATIONS } from "../core/text-limit.js";
import { complain, toast } from "../core/toasts.js";

/** @import { Invitation, NewInvitation, ReceivedTake, ReceivedTakeOutlook } from "../core/types.d.ts" */

const PEOPLE = 2; // With whoever wrote the language they are three, from which on it is foretold.
const DAYS = [1, 7, 30];
const MOST_SHOWN = 5;

const THIS_MACHINE = ["localhost", "127.0.0.1", "[::1]"];

/**
 * What hinders phones at this address, and what to do; empty: nothing.
 *
 * @param {string} link
 */
export function hindrance(link) {
  const { protocol, hostname } = new URL(link);
  if (THIS_MACHINE.includes(hostname))
    return "Phones do not reach this address, which is only this computer\u2019s. Open the studio under its address in the network, and make the link there.";
  return protocol === "https:"
    ? ""
    : "Over http phones record with their own camera, one gesture at a time. With https they show them hands-free; the documentation says how.";
}

/**
 * What became of a take, in words.
 *
 * @param {Pick<ReceivedTake, "diver" | "status" | "reason">} take
 */
export function outcome({ diver, status, reason }) {
  if (status === "asked") return `${diver} is asked: ${reason}`;
  if (status === "waiting") return reason ? `Waits for you. ${reason}` : "is looked at";
  return reason ? `${status}: ${reason}` : status;
}

/** Whether a take waits for an answer: of its person, or of the owner. */
const isHeld = (/** @type {ReceivedTake} */ { status, reason }) =>
  status === "asked" || (status === "waiting" && reason !== null);

/**
 * What the language would read with a take, in words.
 *
 * @param {Pick<ReceivedTakeOutlook, "known" | "repaired" | "broken">} outlook
 */
export const forecast = ({ known, repaired, broken }) =>
  known
    ? `Of ${plural(known, "known take")} this repairs ${repaired} and breaks ${broken}.`
    : "No take of the test set or of practice tells what it changes.";

/** @type {Map<string, Promise<ReceivedTakeOutlook>>} */
const outlooks = new Map(); // by take and revision: each takes seconds to compute

/**
 * @param {string} invitation
 * @param {string} take
 */
function outlookOf(invitation, take) {
  const { id: language, revision } = currentLanguage();
  const key = `${take} ${revision}`;
  const found = outlooks.get(key) ?? api.invitations.outlook(language, invitation, take);
  outlooks.set(key, found);
  found.catch(() => outlooks.delete(key));
  return found;
}

/**
 * A held take as it was shown, its drawing beside that of the gesture, and what it would change.
 *
 * @param {string} invitation
 * @param {ReceivedTake} take
 */
async function showTake(invitation, { id, label, clip_id: clip }) {
  const { id: language, revision } = currentLanguage();
  const outlook = await outlookOf(invitation, id);
  const drawing = (/** @type {string} */ src, /** @type {string} */ words) =>
    h(
      "figure",
      {},
      h("img", { src, alt: "", width: 112, height: 112 }),
      h("figcaption", {}, words),
    );
  return [
    h("video", {
      src: `${api.clips.video({ id: clip })}#t=${outlook.start},${outlook.end}`,
      controls: true,
      muted: true,
      playsInline: true,
      preload: "metadata",
      "aria-label": `The take of ${label}`,
    }),
    drawing(outlook.image, "This take"),
    drawing(api.languages.image(language, label, revision), label),
    h("p", {}, forecast(outlook)),
  ];
}

/**
 * One take that came in, with what can be done about it.
 *
 * @param {string} invitation
 * @param {ReceivedTake} take
 * @param {(take: ReceivedTake, status: "added" | "removed") => void} settle
 */
function takeRow(invitation, take, settle) {
  const { label, diver, status } = take;
  const held = isHeld(take);
  const button = (/** @type {"added" | "removed"} */ next, /** @type {string} */ words) =>
    h(
      "button",
      {
        type: "button",
        ...WRITES,
        "aria-label": `${words} ${label} by ${diver}`,
        onclick: () => settle(take, next),
      },
      words,
    );
  const shown = h("div", { className: "received-take" });
  if (held)
    showTake(invitation, take).then(
      (parts) => shown.replaceChildren(...parts),
      (error) => shown.replaceChildren(h("p", { className: "dim" }, error.message)),
    );
  return h(
    "li",
    { className: `received ${held ? "held" : status}` },
    h("span", {}, h("b", {}, label), ` by ${diver}`),
    h("span", { className: "dim" }, outcome(take)),
    held || status === "removed" ? button("added", "Add") : null,
    held || status === "added" ? button("removed", "Remove") : null,
    held ? shown : null,
  );
}

/** @param {NewInvitation} made */
function showLink({ link, qr, expires, most_takes: takes }) {
  const dialog = byId("dialog");
  const warning = hindrance(link);
  dialog.replaceChildren(
    h(
      "div",
      { className: "invitation-link" },
      h("h2", { id: "dialog-title" }, "Let others scan this"),
      h("img", {
        src: `data:image/svg+xml,${encodeURIComponent(qr)}`,
        alt: "QR code of the link",
        width: 260,
        height: 260,
      }),
      h("p", { className: "link-text num" }, link),
      warning ? h("p", { className: "hindrance" }, warning) : null,
      h(
        "p",
        { className: "dim" },
        `Who has it sees these gestures and adds takes, ${takes} in all, until ${dateAndTime(expires)}; nothing else. It is shown only now.`,
      ),
      h(
        "div",
        { className: "dialog-actions" },
        h("button", { type: "button", onclick: () => dialog.close() }, "Close"),
        h(
          "button",
          { type: "button", className: "primary", onclick: () => copy(link, "Link copied", "") },
          "Copy the link",
        ),
      ),
    ),
  );
}

/** @param {() => void} made Called when there is a new invitation. */
function openForm(made) {
  const dialog = byId("dialog");
  const { id, name } = currentLanguage();
  /** @type {(id: string, values: number[], chosen: number) => HTMLSelectElement} */
  const choice = (id, values, chosen) =>
    h(
      "select",
      { id },
      values.map((each) => h("option", { value: each, selected: each === chosen }, each)),
    );
  const counts = Array.from({ length: MAX_DEMONSTRATIONS - 1 }, (_, index) => index + 1);
  const people = choice("invited-people", counts, PEOPLE);
  const days = choice("invited-days", DAYS, DAYS[1]);
  const problem = h("p", { className: "field-problem", role: "alert", hidden: true });
  const button = h("button", { type: "submit", className: "primary" }, "Make the link");
  const form = h(
    "form",
    {},
    h("h2", { id: "dialog-title" }, `Invite people to ${name}`),
    h(
      "p",
      { className: "dim" },
      "They open a link on their phones and show each gesture once. Every take is checked, and added as theirs, returned with the reason, or held for you.",
    ),
    h("div", { className: "field" }, h("label", { for: "invited-people" }, "People"), people),
    h("div", { className: "field" }, h("label", { for: "invited-days" }, "Days"), days),
    problem,
    h(
      "div",
      { className: "dialog-actions" },
      h("button", { type: "button", onclick: () => dialog.close() }, "Cancel"),
      button,
    ),
  );
  form.onsubmit = async (event) => {
    event.preventDefault();
    button.disabled = true;
    try {
      const limits = { people: Number(people.value), days: Number(days.value) };
      showLink(await api.invitations.make(id, limits));
      made();
    } catch (error) {
      problem.textContent = error.message;
      problem.hidden = false;
      button.disabled = false;
    }
  };
  dialog.replaceChildren(form);
  dialog.setAttribute("aria-labelledby", "dialog-title");
  dialog.onclose = null;
  dialog.showModal();
}

/**
 * One invitation with what came in by it.
 *
 * @param {Invitation} invitation
 * @param {() => void} withdraw
 * @param {(status: "added" | "removed", ...takes: ReceivedTake[]) => void} settle
 */
function row({ id, created, expires, closed, most_takes: most, takes, shown }, withdraw, settle) {
  const end = closed ?? `valid until ${dateAndTime(expires)}`;
  const kept = shown.filter((take) => isHeld(take) || take.status === "added");
  const button = (/** @type {string} */ words, /** @type {() => void} */ onclick) =>
    h("button", { type: "button", ...WRITES, onclick }, words);
  return h(
    "li",
    { className: `invitation ${closed ? "closed" : ""}` },
    h(
      "p",
      {},
      `Made ${ago(created)}, ${closed === "expired" ? "over" : end}. ${takes} of ${most} takes sent.`,
    ),
    closed ? null : button("Withdraw", withdraw),
    closed && kept.length
      ? button("Take back what came in", () => settle("removed", ...kept))
      : null,
    h(
      "ul",
      { "aria-label": "Takes" },
      shown.map((take) => takeRow(id, take, (each, status) => settle(status, each))),
    ),
  );
}

/** Make the part of the health view that invites people, and keep it in step. */
export function invitationsPart() {
  const list = h("ul", { className: "invitations", "aria-label": "Invitations" });
  const button = h(
    "button",
    { type: "button", ...WRITES, onclick: () => openForm(load) },
    "Invite people",
  );
  const part = h("div", { className: "invite" }, button, list);
  let drawn = "";

  async function load() {
    const language = state.gestures?.id;
    if (!language) return;
    const found = await api.invitations.list(language).catch(() => null); // Asked again later.
    if (!found || language !== state.gestures?.id) return;
    const kept = found.filter(({ closed, takes }) => !closed || takes).slice(0, MOST_SHOWN);
    const now = JSON.stringify([language, kept]);
    if (now === drawn) return;
    drawn = now;
    list.hidden = !kept.length;
    list.replaceChildren(
      ...kept.map((each) => row(each, () => withdraw(language, each), settling(language, each))),
    );
  }

  /** @type {(language: string, invitation: Invitation) => (status: "added" | "removed", ...takes: ReceivedTake[]) => Promise<void>} */
  const settling =
    (language, { id }) =>
    async (status, ...takes) => {
      try {
        for (const take of takes) await api.invitations.settle(language, id, take.id, status);
      } catch (error) {
        complain(error, status === "added" ? "Adding the take" : "Removing the take");
      }
      load();
    };

  /**
   * @param {string} language
   * @param {Invitation} invitation
   */
  async function withdraw(language, invitation) {
    try {
      await api.invitations.withdraw(language, invitation.id);
      toast(
        "Invitation withdrawn",
        "Its link does nothing any more. What was added stays, until you take it back.",
      );
    } catch (error) {
      complain(error, "Withdrawing the invitation");
    }
    load();
  }

  follow(["view", "gestures", "clips", "health"], ({ view, gestures, health }) => {
    const forecast = health?.id === gestures?.id ? health?.report?.forecast : null;
    button.classList.toggle("primary", Boolean(forecast?.asks_more));
    part.hidden = !gestures?.gestures.length;
    if (view === "health" && gestures?.gestures.length) load();
  });
  return part;
}
