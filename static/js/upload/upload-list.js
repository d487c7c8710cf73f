// Files dropped anywhere in the window: clips are uploaded two at a time, languages imported.

import { loadClip } from "../clips/clip-pages.js";
import { needsTopic, offer } from "../clips/clip-store.js";
import { openTopics } from "../clips/topic-dialog.js";
import { tabStore } from "../core/browser-store.js";
import { byId } from "../core/dom.js";
import { bytes, timeLeft } from "../core/format.js";
import { state, update } from "../core/state.js";
import { mayWrite, READS_ONLY } from "../core/session.js";
import { complain, toast } from "../core/toasts.js";
import { importLanguage } from "../languages/language-store.js";
import { html, iconButtonOf, iconOf, nothing, progressBar, render, repeat } from "../templates.js";
import { offerToJoin } from "./chapters.js";
import { askForVideo, kindOfJson, needsVideo } from "./keypoint-files.js";
import { upload as send } from "./tus-upload.js";

/** @import { State, Upload } from "../core/types.d.ts" */

const UNSENT = "osg-studio.unsent"; // Names of files that a reload has dropped.

const AT_ONCE = 2; // More would share the same bandwidth, and each would finish later.

let counter = 0;

const unsent = () => state.uploads.filter(({ status }) => status !== "failed");

addEventListener("beforeunload", (event) => {
  if (unsent().length) event.preventDefault(); // The browser asks.
});
addEventListener("pagehide", () => {
  const names = unsent().map(({ file }) => file.name);
  if (names.length) tabStore.write(UNSENT, names);
});

/** Tell which files were not sent when this tab was left. */
export function tellUnsent() {
  /** @type {string[]} */
  const names = tabStore.read(UNSENT) ?? [];
  tabStore.set(UNSENT, null);
  if (!names.length) return;
  const named = names.slice(0, 3).join(", ") + (names.length > 3 ? ", \u2026" : "");
  toast(
    names.length === 1 ? "1 file was not sent" : `${names.length} files were not sent`,
    `Choose again: ${named}`,
    { kind: "error" },
  );
}

/** An upload that has not begun. */
/** @type {(file: File, fields: Upload["fields"], first: boolean, uploaded: Upload["uploaded"]) => Upload} */
const waiting = (file, fields, first, uploaded) => ({
  key: String(counter++),
  file,
  first,
  uploaded,
  fields,
  status: "waiting",
  loaded: 0,
  total: file.size,
  away: false,
  began: null,
  error: null,
  cancel: null,
});

/**
 * Import a .json file if it is a language; resolves to whether it is a clip instead.
 *
 * @param {File} file
 */
async function isClip(file) {
  const kind = await kindOfJson(file);
  if (kind === "language") importLanguage(file);
  else if (kind === "frame")
    toast(
      "One frame of OpenPose is not a clip",
      "Pack the folder that --write_json wrote as a .zip file, and drop the .zip.",
      { kind: "error" },
    );
  return kind === "keypoints";
}

/**
 * Upload or import files. `uploaded(id)` is called for each clip; without it the first clip
 * is shown.
 *
 * @param {Iterable<File>} files
 * @param {Upload["uploaded"]} [uploaded]
 */
export async function addFiles(files, uploaded = null) {
  if (!mayWrite()) {
    toast("Nothing was added", READS_ONLY, { kind: "error" });
    return;
  }
  const added = [];
  // A copy: the browser soon empties the list of a drop or of the field.
  for (const { file, fields } of await offerToJoin([...files])) {
    if (!/\.json$/i.test(file.name) || (await isClip(file)))
      added.push(waiting(file, fields, !added.length, uploaded));
  }
  if (added.length) update({ uploads: [...state.uploads, ...added] });
  startNext();
}

/**
 * @param {string} key
 * @param {Partial<Upload>} patch
 */
function change(key, patch) {
  update({
    uploads: state.uploads.map((upload) => (upload.key === key ? { ...upload, ...patch } : upload)),
  });
}

/** @param {string} key */
function forget(key) {
  update({ uploads: state.uploads.filter((upload) => upload.key !== key) });
}

function startNext() {
  const running = state.uploads.filter((upload) => upload.status === "uploading").length;
  for (const upload of state.uploads
    .filter((each) => each.status === "waiting")
    .slice(0, AT_ONCE - running))
    start(upload);
}

/** @param {Upload} upload */
async function start(upload) {
  const { clip: before } = state;
  // The rate counts from where this attempt began, which may be the middle of the file.
  /** @type {Upload["began"]} */
  let began = null;
  /** @type {(loaded: number, away: boolean) => void} */
  const advanced = (loaded, away) => {
    began = away ? null : (began ?? { loaded, at: performance.now() });
    // While the server is away, the stored bytes are unknown: the bytes sent are shown.
    const sent = state.uploads.find(({ key }) => key === upload.key)?.loaded ?? 0;
    change(upload.key, { loaded: away ? Math.max(loaded, sent) : loaded, away, began });
  };
  const call = send(upload.file, upload.fields, advanced);
  change(upload.key, {
    status: "uploading",
    cancel: call.cancel,
    loaded: 0,
    away: false,
    began: null,
    error: null,
  });
  try {
    const id = await call.done;
    forget(upload.key);
    const clip = await loadClip(id);
    // Of several files only the first is shown; none replaces what the user has chosen meanwhile.
    if (upload.uploaded) upload.uploaded(id);
    else if (upload.first && [before, state.offered].includes(state.clip)) offer(id);
    if (needsTopic(clip)) openTopics(clip);
  } catch (error) {
    if (error.code === "cancelled") forget(upload.key);
    else change(upload.key, { status: "failed", error: error.message, refused: error });
    if (needsVideo(error)) askAboutVideo(upload.key);
  }
  startNext();
}

/**
 * Ask for what a keypoint file lacks, and upload it again with the answer.
 *
 * @param {string} key
 */
async function askAboutVideo(key) {
  const { file, refused, fields } = state.uploads.find((each) => each.key === key) ?? {};
  if (!file || !refused || byId("dialog").open) return; // Retry asks again.
  const given = await askForVideo(file.name, refused, fields);
  if (!given) return;
  change(key, { status: "waiting", fields: { ...fields, ...given } });
  startNext();
}

/** @param {Upload} upload */
function retry({ key, refused }) {
  if (refused && needsVideo(refused)) return askAboutVideo(key);
  change(key, { status: "waiting" });
  return startNext();
}

/**
 * The error without the file's name, which is already shown above it.
 *
 * @param {string} error
 * @param {string} name
 */
function withoutName(error, name) {
  if (error.startsWith(`${name}: `)) return error.slice(name.length + 2);
  return error.startsWith(name) ? `It${error.slice(name.length)}` : error;
}

/** @param {Upload} upload */
function stage(upload) {
  if (upload.status === "waiting") return "Waiting for the other uploads";
  if (upload.status === "failed") return withoutName(upload.error ?? "", upload.file.name);
  if (upload.away)
    return `Connection lost at ${bytes(upload.loaded)} of ${bytes(upload.total)}; the upload continues by itself`;
  if (upload.loaded >= upload.total) return "Checking the file";
  const { began } = upload;
  // bytes a ms
  const rate = began && (upload.loaded - began.loaded) / (performance.now() - began.at);
  const left = rate ? (upload.total - upload.loaded) / rate / 1000 : null;
  return `Uploading ${bytes(upload.loaded)} of ${bytes(upload.total)}${left === null ? "" : `, ${timeLeft(left)}`}`;
}

/** @param {Upload} upload */
function item(upload) {
  const { key, status, file, total, loaded } = upload;
  const failed = status === "failed";
  const stop = () => (status === "uploading" ? upload.cancel?.() : forget(key));
  return html`<li class="clip ${failed ? "failed" : ""}" data-status=${status}>
    <div class="poster blank">${iconOf("plus")}</div>
    <div class="clip-text">
      <b>${file.name}</b>
      <span class="stage-text">${stage(upload)}</span>
      ${failed ? nothing : progressBar(`Upload of ${file.name}`, loaded, total)}
    </div>
    <div class="clip-buttons">
      ${failed ? iconButtonOf("retry", `Retry ${file.name}`, () => retry(upload)) : nothing}${iconButtonOf(
        "close",
        `${failed ? "Dismiss" : "Cancel"} ${file.name}`,
        stop,
      )}
    </div>
  </li>`;
}

/**
 * Draw the uploads.
 *
 * @param {State} state
 */
export function drawUploads({ uploads }) {
  render(
    repeat(uploads, ({ key }) => key, item),
    byId("uploads"),
  );
}

/** @type {Map<string | null, (files: Iterable<File>) => unknown>} */
const takers = new Map();

/**
 * Pass files that are dropped on a view to `take(files)`.
 *
 * @param {string} view
 * @param {(files: Iterable<File>) => unknown} take
 */
export const takeFilesIn = (view, take) => takers.set(view, take);

/** Make the whole window a place to drop files. */
export function acceptFiles() {
  const veil = byId("veil");
  let depth = 0; // dragenter and dragleave fire for every element on the way.
  const enter = (/** @type {number} */ deep) => {
    depth = deep;
    veil.hidden = depth <= 0;
  };
  /** @param {DragEvent} event */
  const carriesFiles = (event) => [...(event.dataTransfer?.types ?? [])].includes("Files");
  addEventListener("dragenter", (event) => {
    if (carriesFiles(event)) enter(depth + 1);
  });
  addEventListener("dragleave", (event) => {
    if (carriesFiles(event)) enter(depth - 1);
  });
  addEventListener("dragover", (event) => carriesFiles(event) && event.preventDefault());
  addEventListener("drop", (event) => {
    if (!carriesFiles(event)) return;
    event.preventDefault();
    enter(0);
    const take = takers.get(state.view) ?? addFiles;
    Promise.resolve(take(event.dataTransfer?.files ?? [])).catch((error) =>
      complain(error, "Adding the files"),
    );
  });
  const input = byId("file");
  input.onchange = () => {
    addFiles(input.files).catch((error) => complain(error, "Adding the files"));
    input.value = "";
  };
}
