// The rows of the test with clips: uploads, clips that wait for a label, and tested takes.

import { statusText } from "../clips/clip-store.js";
import { h, iconButton, WRITES } from "../core/dom.js";
import { askWhich } from "../core/format.js";
import { state } from "../core/state.js";
import { address, go, here } from "../core/views.js";
import { labelTake } from "../languages/test-set.js";
import { leaveOut, leaveWaiting, means, waitingClips } from "./test-set-clips.js";

/** @import { Upload } from "../core/types.d.ts" */

/** @import { TestedTake } from "./test-set-results.js" */

/** @typedef {ReturnType<typeof waitingClips>[number]} WaitingClip */

export const REFUSED = "refused";
export const ASKED = "asked back";

export const labels = () => state.gestures?.labels ?? [];

/** @param {Pick<TestedTake, "label" | "pair">} take */
export const readAs = ({ label, pair }) => label ?? (pair ? ASKED : REFUSED);

/**
 * The order of a take among others: the wrong ones come first, then those that were asked back.
 *
 * @param {Pick<TestedTake, "right" | "pair">} take
 */
export const rankOf = ({ right, pair }) => (right ? 2 : pair ? 1 : 0);

/**
 * @param {string} name
 * @param {string} value
 * @param {(label: string) => void} onchange
 */
function labelSelect(name, value, onchange) {
  const known = value && !labels().includes(value) ? [value] : [];
  const select = h(
    "select",
    { "aria-label": `What ${name} shows`, ...WRITES, onchange: () => onchange(select.value) },
    value ? null : h("option", { value: "" }, "choose\u2026"),
    [...labels(), ...known].map((label) =>
      h("option", { value: label, selected: label === value }, label),
    ),
  );
  return select;
}

export const uploadsHere = () => state.uploads.filter(({ uploaded }) => uploaded);

/** The progress of each clip that is not in the test yet, as `{ key, text, total, done }`. */
function advances() {
  const uploads = uploadsHere().map(({ key, status, error, total, loaded }) => ({
    key: `upload ${key}`,
    text:
      status === "failed"
        ? error
        : status === "waiting"
          ? "Waiting for the other uploads"
          : "Uploading",
    total: Math.max(1, total),
    done: loaded,
  }));
  const clips = waitingClips().map(({ clip, expected }) => {
    const job = state.jobs.get(clip.job_id);
    return {
      key: clip.id,
      text:
        clip.status === "done"
          ? expected
            ? "Recognising"
            : "Choose its label"
          : statusText(clip, job),
      total: job?.total,
      done: job?.done,
    };
  });
  return [...uploads, ...clips];
}

/**
 * Update texts and bars in the existing rows, so that a control being pressed stays in place.
 *
 * @param {HTMLElement} content
 */
export function advance(content) {
  const rows = new Map(
    /** @type {HTMLElement[]} */ ([...content.querySelectorAll("tr.waiting")]).map((row) => [
      row.dataset.key,
      row,
    ]),
  );
  for (const { key, text, total, done } of advances()) {
    const row = rows.get(key);
    if (!row) continue;
    row.querySelector(".stage-text")?.replaceChildren(text ?? "");
    const bar = row.querySelector("progress");
    if (bar && total) Object.assign(bar, { max: total, value: done });
  }
}

/** @param {WaitingClip} waiting */
export function waitingRow({ clip, expected, busy }) {
  return h(
    "tr",
    { className: "waiting", "data-key": clip.id },
    h("td", {}, clip.name),
    h(
      "td",
      {},
      labelSelect(clip.name, expected, (label) => means(clip.id, label)),
    ),
    h(
      "td",
      { colSpan: 2 },
      h("span", { className: "stage-text" }),
      busy ? h("progress", { "aria-label": `Poses of ${clip.name}` }) : null,
    ),
    h(
      "td",
      {},
      iconButton("close", `Leave ${clip.name} out of the test`, () => leaveWaiting(clip)),
    ),
  );
}

/** @param {Upload} upload */
export function uploadRow({ key, file, status, cancel }) {
  return h(
    "tr",
    { className: "waiting", "data-key": `upload ${key}` },
    h("td", {}, file.name),
    h("td", {}),
    h(
      "td",
      { colSpan: 2 },
      h("span", { className: "stage-text" }),
      status === "failed" ? null : h("progress", { "aria-label": `Upload of ${file.name}` }),
    ),
    h(
      "td",
      {},
      status === "uploading" && cancel ? iconButton("close", `Cancel ${file.name}`, cancel) : null,
    ),
  );
}

/**
 * The address that shows a take and its recognition.
 *
 * @param {TestedTake} take
 * @param {TestedTake[]} takes
 */
export function placeOf(take, takes) {
  const alone = takes.filter((each) => each.clip_id === take.clip_id).length === 1;
  return {
    clip: take.clip_id,
    recognition: take.recognition_id,
    take: null,
    start: alone ? null : take.start,
    end: alone ? null : take.end,
    frame: null,
    pair: null,
  };
}

/**
 * What else is known about the result of a take, in words.
 *
 * @param {TestedTake} take
 */
function notesOf({ fault, demonstration, pair, expected, label, nearest }) {
  return [
    fault,
    demonstration ? "a demonstration" : null,
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
  if (!take.known) return [h("span", { className: "dim" }, "not recognised yet")];
  const { pair } = take;
  const extra = notesOf(take);
  const [sign, word] = [
    ["\u2260", "wrong: "],
    ["?", "asked back: "],
    ["\u2713", "right: "],
  ][rankOf(take)];
  return [
    h("span", { className: "outcome-sign", "aria-hidden": "true" }, sign),
    h("span", {}, word),
    h("b", {}, pair ? askWhich(pair) : readAs(take)),
    extra.length ? h("small", { className: "dim" }, `, ${extra.join(", ")}`) : null,
    take.change ? h("span", { className: `tag ${take.change}` }, take.change) : null,
  ];
}

/**
 * @param {TestedTake} take
 * @param {TestedTake[]} takes
 */
export function takeRow(take, takes) {
  const several = takes.filter((each) => each.clip_id === take.clip_id);
  const name = several.length > 1 ? `${take.clip}, take ${several.indexOf(take) + 1}` : take.clip;
  const place = placeOf(take, takes);
  return h(
    "tr",
    {
      className:
        take.demonstration || !take.known ? "demonstration" : ["wrong", "asked", ""][rankOf(take)],
    },
    h(
      "td",
      {},
      h(
        "a",
        {
          href: address("studio", place),
          title: "Show the clip and why",
          onclick: here(() => go("studio", place)),
        },
        name,
      ),
      take.added_by ? h("small", { className: "dim" }, ` by ${take.added_by}`) : null,
    ),
    h(
      "td",
      {},
      labelSelect(name, take.expected, (label) => labelTake(take.id, label)),
    ),
    h("td", {}, outcomeOf(take)),
    h(
      "td",
      { className: "num" },
      take.recognition_id ? `${Math.round(100 * take.confidence)} %` : "",
    ),
    h(
      "td",
      {},
      iconButton("close", `Leave ${name} out of the test`, () => leaveOut(take, name), WRITES),
    ),
  );
}
