// The rows of the test with clips: uploads, clips that wait for a label, and tested takes.

import { statusText } from "../clips/clip-store.js";
import { answerOf, rankOf, takeLink, takeRow } from "../clips/takes.js";
import { percent } from "../core/format.js";
import { placeIn, state } from "../core/state.js";
import { buttonOf, html, iconButtonOf, live, progressBar } from "../templates.js";
import { labelTake, NONE } from "../languages/test-set.js";
import { leaveOut, leaveWaiting, means } from "./test-set-clips.js";

/** @import { Upload } from "../core/types.d.ts" */

/** @import { TestedTake } from "./test-set-results.js" */

/** @typedef {ReturnType<typeof import("./test-set-clips.js").waitingClips>[number]} WaitingClip */

export const labels = () => state.gestures?.labels ?? [];

/**
 * @param {string} name
 * @param {string} value
 * @param {(label: string) => void} choose
 */
function labelSelect(name, value, choose) {
  const known = value && !labels().includes(value) ? [value] : [];
  return html`<select
    aria-label="What ${name} shows"
    data-writes
    @change=${(/** @type {any} */ { target }) => choose(target.value)}
  >
    ${value ? "" : html`<option value="">choose…</option>`}
    ${[...new Set([...labels(), ...known, NONE])].map(
      (label) => html`<option value=${label} .selected=${live(label === value)}>${label}</option>`,
    )}
  </select>`;
}

export const uploadsHere = () => state.uploads.filter(({ uploaded }) => uploaded);

/**
 * A row of a clip that is not in the test yet.
 *
 * @param {string} name
 * @param {{ shows: unknown, text: string | null | undefined, progress: unknown, close: unknown }} cells
 */
const waiting = (name, { shows, text, progress, close }) =>
  takeRow(
    [name, shows, html`<span class="stage-text">${text}</span>${progress}`, "", close],
    "waiting",
  );

/** @param {WaitingClip} waiting */
export function waitingRow({ clip, expected, busy }) {
  const job = state.jobs.get(clip.job_id);
  return waiting(clip.name, {
    shows: labelSelect(clip.name, expected, (label) => means(clip.id, label)),
    text:
      clip.status !== "done"
        ? statusText(clip, job)
        : expected
          ? "Recognising"
          : "Choose its label",
    progress: busy ? progressBar(`Poses of ${clip.name}`, job?.done, job?.total) : "",
    close: iconButtonOf("close", `Leave ${clip.name} out of the test`, () => leaveWaiting(clip)),
  });
}

/** @param {Upload} upload */
export const uploadRow = ({ file, status, cancel, error, loaded, total }) =>
  waiting(file.name, {
    shows: "",
    text:
      status === "failed"
        ? error
        : status === "waiting"
          ? "Waiting for the other uploads"
          : "Uploading",
    progress:
      status === "failed" ? "" : progressBar(`Upload of ${file.name}`, loaded, Math.max(1, total)),
    close:
      status === "uploading" && cancel ? iconButtonOf("close", `Cancel ${file.name}`, cancel) : "",
  });

/**
 * The address that shows a take and its recognition.
 *
 * @param {TestedTake} take
 * @param {TestedTake[]} takes
 */
export function placeOf(take, takes) {
  const alone = takes.filter((each) => each.clip_id === take.clip_id).length === 1;
  const { recognition_id: recognition, start, end } = take;
  const range = alone ? { recognition } : { recognition, start, end };
  return { ...placeIn(take.clip_id, range), pair: null };
}

/**
 * What else is known about the result of a take, in words.
 *
 * @param {TestedTake} take
 */
function notesOf({ fault, demonstration, pair, expected, label, nearest }) {
  return [
    fault,
    demonstration ? "read without itself, a demonstration" : null,
    pair ? `the right one is ${pair.includes(expected) ? "" : "not "}in it` : null,
    label === null && !pair && nearest ? `nearest ${nearest}` : null,
  ].filter(Boolean);
}

/**
 * The result of a take in words, and whether it is better or worse than before.
 *
 * @param {TestedTake} take
 */
function outcomeOf(take) {
  if (take.set_aside)
    return html`<span class="dim">set aside: the gesture has another movement now</span> ${buttonOf(
        "Count it again",
        () => labelTake(take.id, take.expected),
        { look: "link", writes: true },
      )}`;
  if (!take.testable)
    return html`<span class="dim"
      >cannot be tested:
      ${take.demonstration ? "the only demonstration" : "the language lacks it"}</span
    >`;
  if (!take.known) return html`<span class="dim">not recognised yet</span>`;
  const { change } = take;
  return html`${answerOf(take, notesOf(take).join(", "))}${
    change && html`<span class="tag ${change}">${change}</span>`
  }`;
}

/**
 * @param {TestedTake} take
 * @param {TestedTake[]} takes
 */
export function testedRow(take, takes) {
  const several = takes.filter((each) => each.clip_id === take.clip_id);
  const name = several.length > 1 ? `${take.clip}, take ${several.indexOf(take) + 1}` : take.clip;
  const look = take.known ? ["wrong", "asked", ""][rankOf(take)] : "demonstration";
  return takeRow(
    [
      html`${takeLink(name, placeOf(take, takes))}${
        take.added_by && html`<small class="dim"> by ${take.added_by}</small>`
      }`,
      labelSelect(name, take.expected, (label) => labelTake(take.id, label)),
      outcomeOf(take),
      take.recognition_id ? html`<span class="num">${percent(take.confidence)}</span>` : "",
      iconButtonOf("close", `Leave ${name} out of the test`, () => leaveOut(take, name), {
        writes: true,
      }),
    ],
    look,
  );
}
