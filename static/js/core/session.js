// The session: the name and the role of the token, what that role cannot do, and log-out.

import * as api from "./api.js";
import { byId } from "./dom.js";
import { state, update } from "./state.js";
import { attempt } from "./toasts.js";

/** @import { Session } from "./types.d.ts" */

/**
 * The name and role of the signed-in user in words; empty where the server needs no token.
 *
 * @param {Pick<Session, "name" | "role">} session
 */
export const describeSession = ({ name, role }) => (name ? `Signed in as ${name} (${role})` : "");

/** Why readers cannot use controls that write. */
export const READS_ONLY =
  "Your token has the role read. Ask an administrator for one with the role edit to change this.";

/** Whether the user may change shared data. */
export const mayWrite = () => state.role !== "read";

/**
 * Disable controls that write, and say why; a control that gets enabled again is disabled again.
 *
 * @param {Iterable<HTMLElement>} controls
 */
function disable(controls) {
  for (const control of controls) {
    if (control.title !== READS_ONLY) control.title = READS_ONLY;
    control.dataset.writes = "no"; // The label of a disabled field looks disabled too.
    if ("disabled" in control && !control.disabled) control.disabled = true;
  }
}

/** Disable all controls that write, now and whenever something is drawn. */
function holdToReading() {
  const hold = () => disable(document.querySelectorAll("[data-writes]"));
  new MutationObserver(hold).observe(document.body, {
    subtree: true,
    childList: true,
    attributeFilter: ["disabled", "title"],
  });
  hold();
}

/** Show who is signed in, with a button to log out where a cookie keeps the token. */
export async function showSession() {
  const session = await attempt("Reading who is signed in", api.session.get);
  update({ role: session?.role ?? null, quota: session?.quota ?? null });
  if (!mayWrite()) holdToReading();
  if (!session?.name) return;
  byId("session-name").textContent = describeSession(session);
  byId("audit-log").hidden = session.role !== "admin";
  byId("log-out").hidden = !session.signed_in;
  byId("log-out").onclick = () =>
    attempt("Logging out", async () => {
      await api.session.end();
      location.assign("./");
    });
  byId("session").hidden = false;
}
