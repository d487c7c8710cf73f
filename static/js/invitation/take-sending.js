// What an invited person's page asks the server: the gestures to show, and what became of takes.

import { ApiError, BASE, problemOf, unreachable } from "../core/server.js";

/** @import { Invited, InvitedTake } from "../core/types.d.ts" */

const PLACE = `${BASE}/invited`;
const LOOK = 1500; // ms between two looks whether a take is judged; its poses take some seconds.

// Behind the "#", which browsers do not send.
export const token = () => location.hash.slice(1);

/**
 * @param {string} path
 * @param {RequestInit & { headers?: Record<string, string> }} [more]
 */
async function request(path, { headers = {}, ...more } = {}) {
  let response;
  try {
    const authorization = { Authorization: `Bearer ${token()}` };
    response = await fetch(PLACE + path, { headers: { ...authorization, ...headers }, ...more });
  } catch {
    throw unreachable();
  }
  if (!response.ok) throw new ApiError(await problemOf(response), response.status);
  return response.json();
}

/** @type {() => Promise<Invited>} */
export const findInvited = () => request("");

const takeAt = (/** @type {string} */ id) => `/takes/${encodeURIComponent(id)}`;

/**
 * Answer whether a take is the gesture that it was sent as.
 *
 * @param {string} id
 * @param {boolean} confirmed
 * @returns {Promise<InvitedTake>}
 */
export const answerTake = (id, confirmed) =>
  request(`${takeAt(id)}/answer`, {
    method: "PUT",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify({ confirmed }),
  });

/**
 * Send the clip of a take; `progress` gets the share that is sent. `cancel` ends it, and then
 * `answer` never comes.
 *
 * @param {{ label: string, diver: string, file: File, progress: (share: number) => void }} take
 * @returns {{ answer: Promise<InvitedTake>, cancel: () => void }}
 */
export function sendTake({ label, diver, file, progress }) {
  const request = new XMLHttpRequest(); // fetch tells no progress of what is sent.
  const form = new FormData();
  form.append("file", file);
  request.open("POST", `${PLACE}/takes?${new URLSearchParams({ label, diver })}`);
  request.setRequestHeader("Authorization", `Bearer ${token()}`);
  request.upload.onprogress = ({ loaded, total }) => progress(total ? loaded / total : 0);
  /** @type {Promise<InvitedTake>} */
  const answer = new Promise((resolve, reject) => {
    request.onerror = () => reject(unreachable());
    request.onload = async () => {
      const response = new Response(request.responseText, {
        status: request.status,
        statusText: request.statusText,
      });
      if (response.ok) resolve(await response.json());
      else reject(new ApiError(await problemOf(response), response.status));
    };
  });
  request.send(form);
  return { answer, cancel: () => request.abort() };
}

/**
 * Wait until a take is judged; a connection that is lost meanwhile is waited for.
 *
 * @param {string} id
 * @returns {Promise<InvitedTake>}
 */
export async function findJudged(id) {
  for (;;) {
    try {
      /** @type {InvitedTake} */
      const take = await request(takeAt(id));
      if (take.status !== "waiting" || take.reason) return take; // With a reason the owner decides.
    } catch (error) {
      if (error.status && error.status < 500) throw error;
    }
    await new Promise((resolve) => {
      setTimeout(resolve, LOOK);
    });
  }
}
