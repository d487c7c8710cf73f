// Invitations: other people add their takes to the language by a link or its QR code.

import { headsOf, takeRow, takesTable } from "../clips/takes.js";
import * as api from "../core/api.js";
import { copy } from "../core/clipboard.js";
import { closeDialog, showDialog } from "../core/dialogs.js";
import { byId, disableDuring } from "../core/dom.js";
import { ago, dateAndTime, plural } from "../core/format.js";
import { currentLanguage, state, update } from "../core/state.js";
import { buttonOf, elementOf, guard, html, nothing, repeat, until } from "../templates.js";
import { MAX_DEMONSTRATIONS } from "../core/text-limit.js";
import { attempt, toast } from "../core/toasts.js";

/** @import { HealthReport, Invitation, NewInvitation, ReceivedTake, ReceivedTakeOutlook, State } from "../core/types.d.ts" */

const PEOPLE = 2; // With whoever wrote the language they are three, from which on it is foretold.
const DAYS = [1, 7, 30]; // The second is chosen at first, as `days` of InvitationDraft.
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

/** @type {Map<string, Promise<unknown>>} */
const drawings = new Map(); // by take and revision: each takes seconds to compute

/**
 * A held take as it was shown, its drawing beside that of the gesture, and what it would change.
 *
 * @param {string} invitation
 * @param {ReceivedTake} take
 */
function drawingOf(invitation, { id, label, clip_id: clip }) {
  const { id: language, revision } = currentLanguage();
  const key = `${id} ${revision}`;
  /** @param {ReceivedTakeOutlook} outlook */
  const draw = (outlook) =>
    html`<video
        src="${api.clips.video({ id: clip })}#t=${outlook.start},${outlook.end}"
        controls
        .muted=${true}
        playsinline
        preload="metadata"
        aria-label="The take of ${label}"
      ></video
      >${figure(outlook.image, "This take")}${figure(
        api.languages.image(language, label, revision),
        label,
      )}
      <p>${forecast(outlook)}</p>`;
  const drawing =
    drawings.get(key) ??
    api.invitations.outlook(language, invitation, id).then(draw, (error) => {
      drawings.delete(key);
      return html`<p class="dim">${error.message}</p>`;
    });
  drawings.set(key, drawing);
  return until(drawing, nothing);
}

/** @type {(src: string, words: string) => unknown} */
const figure = (src, words) =>
  html`<figure>
    <img src=${src} alt="" width="112" height="112" />
    <figcaption>${words}</figcaption>
  </figure>`;

/**
 * One take that came in, with what can be done about it.
 *
 * @param {string} invitation
 * @param {ReceivedTake} take
 * @param {(take: ReceivedTake, status: "added" | "removed") => void} settle
 */
function receivedRow(invitation, take, settle) {
  const { label, diver, status } = take;
  const held = isHeld(take);
  const button = (/** @type {"added" | "removed"} */ next, /** @type {string} */ words) =>
    buttonOf(words, () => settle(take, next), {
      writes: true,
      label: `${words} ${label} by ${diver}`,
    });
  return takeRow(
    [
      html`<b>${label}</b> by ${diver}`,
      html`<span class="dim">${outcome(take)}</span
        >${held ? html`<div class="received-take">${drawingOf(invitation, take)}</div>` : nothing}`,
      html`${held || status === "removed" ? button("added", "Add") : nothing}${
        held || status === "added" ? button("removed", "Remove") : nothing
      }`,
    ],
    held ? "held" : status,
  );
}

/** @param {NewInvitation} made */
function showLink({ link, qr, expires, most_takes: takes }) {
  const warning = hindrance(link);
  showDialog(
    elementOf(
      html`<div class="invitation-link">
        <h2 id="dialog-title">Let others scan this</h2>
        <img
          src="data:image/svg+xml,${encodeURIComponent(qr)}"
          alt="QR code of the link"
          width="260"
          height="260"
        />
        <p class="link-text num">${link}</p>
        ${warning && html`<p class="hindrance">${warning}</p>`}
        <p class="dim">
          Who has it sees these gestures and adds takes, ${takes} in all, until
          ${dateAndTime(expires)}; nothing else. It is shown only now.
        </p>
        <div class="dialog-actions">
          <button type="button" @click=${closeDialog}>Close</button>
          <button type="button" class="primary" @click=${() => copy(link, "Link copied", "")}>
            Copy the link
          </button>
        </div>
      </div>`,
    ),
  );
}

/**
 * @param {string} id
 * @param {string} name
 * @param {number[]} values
 * @param {number} chosen
 */
const choice = (id, name, values, chosen) =>
  html`<div class="field">
    <label for=${id}>${name}</label>
    <select id=${id}>
      ${values.map((each) => html`<option ?selected=${each === chosen}>${each}</option>`)}
    </select>
  </div>`;

function openForm() {
  const { id, name } = currentLanguage();
  const counts = Array.from({ length: MAX_DEMONSTRATIONS - 1 }, (_, index) => index + 1);
  const numberOf = (/** @type {string} */ field) => Number(byId(field).value);
  /** @param {SubmitEvent} event */
  const make = async (event) => {
    event.preventDefault();
    const { submitter: button } = /** @type {any} */ (event);
    const limits = { people: numberOf("invited-people"), days: numberOf("invited-days") };
    try {
      showLink(await disableDuring(button, () => api.invitations.make(id, limits)));
      loadInvitations(state);
    } catch (error) {
      const problem = button.form.querySelector(".field-problem");
      problem.textContent = error.message;
      problem.hidden = false;
    }
  };
  showDialog(
    elementOf(
      html`<form @submit=${make}>
        <h2 id="dialog-title">Invite people to ${name}</h2>
        <p class="dim">
          They open a link on their phones and show each gesture once. Every take is checked, and
          added as theirs, returned with the reason, or held for you.
        </p>
        ${choice("invited-people", "People", counts, PEOPLE)}${choice(
          "invited-days",
          "Days",
          DAYS,
          DAYS[1],
        )}
        <p class="field-problem" role="alert" hidden></p>
        <div class="dialog-actions">
          <button type="button" @click=${closeDialog}>Cancel</button>
          <button type="submit" class="primary">Make the link</button>
        </div>
      </form>`,
    ),
  );
}

/**
 * Load the invitations of the language on display.
 *
 * @param {Pick<State, "view" | "gestures">} state
 */
export async function loadInvitations({ view, gestures }) {
  if (view !== "health" || !gestures?.gestures.length) return;
  const language = gestures.id;
  const found = await api.invitations.list(language).catch(() => null); // Asked again later.
  if (!found || language !== state.gestures?.id) return;
  const kept = found.filter(({ closed, takes }) => !closed || takes).slice(0, MOST_SHOWN);
  update({ invitations: { language, kept } });
}

/**
 * @param {string} language
 * @param {string} invitation
 * @param {"added" | "removed"} status
 * @param {...ReceivedTake} takes
 */
async function settle(language, invitation, status, ...takes) {
  /** @type {[string, "added" | "removed", string]} */
  const [doing, other, label] =
    status === "added"
      ? ["Adding the take", "removed", "Remove it again"]
      : ["Removing the take", "added", "Add it after all"];
  const of = takes.length > 1 ? plural(takes.length, "take") : `Take of ${takes[0].label}`;
  await attempt(doing, async () => {
    for (const take of takes) await api.invitations.settle(language, invitation, take.id, status);
    const back = () => settle(language, invitation, other, ...takes);
    toast(`${of} ${status}`, takes[0].diver, { action: { label, run: back } });
  });
  loadInvitations(state);
}

/**
 * @param {string} language
 * @param {string} invitation
 */
async function withdraw(language, invitation) {
  await attempt("Withdrawing the invitation", async () => {
    await api.invitations.withdraw(language, invitation);
    toast(
      "Invitation withdrawn",
      "Its link does nothing any more. What was added stays, until you take it back.",
    );
  });
  loadInvitations(state);
}

/**
 * One invitation with what came in by it.
 *
 * @param {string} language
 * @param {Invitation} invitation
 */
function row(language, { id, created, expires, closed, most_takes: most, takes, shown }) {
  const end = closed ?? `valid until ${dateAndTime(expires)}`;
  const kept = shown.filter((take) => isHeld(take) || take.status === "added");
  const button = (/** @type {string} */ words, /** @type {() => void} */ run) =>
    html`<button type="button" data-writes @click=${run}>${words}</button>`;
  return html`<li class="invitation ${closed ? "closed" : ""}">
    <p>
      Made ${ago(created)}, ${closed === "expired" ? "over" : end}. ${takes} of ${most} takes sent.
    </p>
    ${closed ? nothing : button("Withdraw", () => withdraw(language, id))}${
      closed && kept.length
        ? button("Take back what came in", () => settle(language, id, "removed", ...kept))
        : nothing
    }
    ${
      shown.length
        ? takesTable(
            "Takes",
            headsOf(["Shows", "Became", ""]),
            repeat(
              shown,
              (take) => take.id,
              (take) => receivedRow(id, take, (each, status) => settle(language, id, status, each)),
            ),
          )
        : nothing
    }
  </li>`;
}

/**
 * The part of the health view that invites people.
 *
 * @param {State} state
 * @param {HealthReport | null} report
 */
export function invitationsPart({ gestures, invitations }, report) {
  const kept = invitations && invitations.language === gestures?.id ? invitations.kept : [];
  const rows = () =>
    repeat(
      kept,
      ({ id }) => id,
      (each) => row(gestures?.id ?? "", each),
    );
  return html`<div class="invite" ?hidden=${!gestures?.gestures.length}>
    ${buttonOf("Invite people", openForm, {
      look: report?.forecast.asks_more ? "primary" : "",
      writes: true,
    })}
    <ul class="invitations" aria-label="Invitations" ?hidden=${!kept.length}>
      ${guard([JSON.stringify(kept)], rows)}
    </ul>
  </div>`;
}
