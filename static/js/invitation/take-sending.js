// What an invited person's page asks the server: the gestures to show, and takes with their answer.

import { ApiError, BASE, problemOf, unreachable } from "../core/api.js";

/** @import { Invited, InvitedTake } from "../core/types.d.ts" */

const PLACE = `${BASE}/invited`;
const LOOK = 1500; // ms between two looks whether a take is judged; its poses take some seconds.

// Behind the "#", which browsers do not send.
const token = () => location.hash.slice(1);

/** @param {string} path */
async function get(path) {
  let response;
  try {
    response = await fetch(PLACE + path, { headers: { Authorization: `Bearer ${token()}` } });
  } catch {
    throw unreachable();
  }
  if (!response.ok) throw new ApiError(await problemOf(response), response.status);
  return response.json();
}

/** @type {() => Promise<Invited>} */
export const findInvited = () => get("");

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
      const take = await get(`/takes/${encodeURIComponent(id)}`);
      if (take.status !== "waiting") return take;
    } catch (error) {
      if (error.status && error.status < 500) throw error;
    }
    await new Promise((resolve) => {
      setTimeout(resolve, LOOK);
    });
  }
}
