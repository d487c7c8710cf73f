// What is left of the signed-in user's quota, below the drop area.

import * as api from "../core/api.js";
import { byId } from "../core/dom.js";
import { bytes, plural } from "../core/format.js";
import { update } from "../core/state.js";

/** @import { Quota, State } from "../core/types.d.ts" */

/**
 * The quota in words.
 *
 * @param {Quota} quota
 */
export function describeQuota({ clips, most_clips, bytes: used, most_bytes }) {
  const parts = [];
  if (most_bytes) parts.push(`${bytes(used)} of ${bytes(most_bytes)}`);
  if (most_clips) parts.push(`${clips} of ${plural(most_clips, "clip")}`);
  return `Your quota: ${parts.join(", ")} used`;
}

/** @param {Pick<State, "quota">} state */
export function drawQuota({ quota }) {
  const line = byId("quota");
  line.hidden = !quota;
  line.textContent = quota ? describeQuota(quota) : "";
}

let known = ""; // the clips counted in the quota on display

/**
 * Read the quota again when clips or uploads were added or removed.
 *
 * @param {Pick<State, "quota" | "clips" | "uploads">} state
 */
export async function followQuota({ quota, clips, uploads }) {
  if (!quota) return;
  const now = `${clips.length} ${clips[0]?.id} ${uploads.map(({ status }) => status)}`;
  if (now === known) return;
  known = now;
  try {
    update({ quota: (await api.session.get()).quota });
  } catch {
    // The line stays unchanged; if an upload is refused, the server's message explains it.
  }
}
