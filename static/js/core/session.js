// Who is signed in: the name and the role of the token, and log-out.

import * as api from "./api.js";
import { byId } from "./dom.js";
import { attempt } from "./toasts.js";

/** @import { Session } from "./types.d.ts" */

/**
 * The words for who is signed in; empty where the server needs no token.
 *
 * @param {Pick<Session, "name" | "role">} session
 */
export const describeSession = ({ name, role }) => (name ? `Signed in as ${name} (${role})` : "");

/** Show who is signed in, with a button to log out where a cookie keeps the token. */
export async function showSession() {
  const session = await attempt("Reading who is signed in", api.session.get);
  if (!session?.name) return;
  byId("session-name").textContent = describeSession(session);
  byId("log-out").hidden = !session.signed_in;
  byId("log-out").onclick = () =>
    attempt("Logging out", async () => {
      await api.session.end();
      location.assign("/");
    });
  byId("session").hidden = false;
}
