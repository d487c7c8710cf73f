// The export of a clip as MCAP: a button, and while the file is written its progress with Cancel.

import * as api from "../core/api.js";
import { h } from "../core/dom.js";
import { percent, timeLeft } from "../core/format.js";
import { follow, state } from "../core/state.js";
import { toast } from "../core/toasts.js";
import { html, progressBar, render } from "../templates.js";

/** @import { ExportProgress } from "../core/types.d.ts" */

/** @type {Map<string, (progress: ExportProgress) => void>} */
const running = new Map(); // what draws the progress, by the name of the export
/** @type {Map<string, HTMLElement>} */
const elements = new Map(); // by clip; kept when the explanation is drawn anew

/**
 * The progress of an export, in words.
 *
 * @param {ExportProgress | null} progress
 */
export function exportWords(progress) {
  if (!progress) return "Preparing the session";
  const { done, total, eta_s: left } = progress;
  if (!total) return "Writing the MCAP file";
  const rest = left === null ? "" : `, ${timeLeft(left)}`;
  return `Writing the MCAP file, ${percent(done / total)}${rest}`;
}

/**
 * Let the browser save a complete file.
 *
 * @param {{ name: string, content: Blob }} file
 */
export function saveFile({ name, content }) {
  const href = URL.createObjectURL(content);
  h("a", { href, download: name }).click();
  // The download has begun by now; the browser keeps the content until it is saved.
  setTimeout(() => URL.revokeObjectURL(href), 60_000);
}

/**
 * @param {HTMLElement} box
 * @param {string} clip
 * @param {string} problem
 */
function drawStart(box, clip, problem) {
  // If the explanation was drawn anew in the meantime, Cancel has lost the focus.
  const focused = document.activeElement;
  const had = box.contains(focused) || (box.isConnected && focused === document.body);
  const note = problem
    ? html`<small class="session-problem" role="alert">${problem}</small>`
    : html`<small class="dim"> opens in Foxglove</small>`;
  render(
    html`<button type="button" class="link" @click=${() => run(box, clip)}>
        ${problem ? "Try the session again" : "Session as MCAP"}</button
      >${note}`,
    box,
  );
  if (had) box.querySelector("button")?.focus({ preventScroll: true });
}

/**
 * @param {HTMLElement} box
 * @param {ExportProgress | null} progress
 * @param {() => void} cancel
 */
const advance = (box, progress, cancel) =>
  render(
    html`<span role="status">${exportWords(progress)}</span>
      ${progressBar("Progress of the session", progress?.done, progress?.total)}
      <button type="button" aria-label="Cancel the session" @click=${cancel}>Cancel</button>`,
    box,
  );

/**
 * Write the session, and let the browser save it while it downloads: it may not fit in memory.
 *
 * @param {HTMLElement} box
 * @param {string} clip
 */
async function run(box, clip) {
  const leaving = new AbortController();
  const name = api.uniqueId();
  /** @param {ExportProgress | null} progress */
  const draw = (progress) => advance(box, progress, () => leaving.abort());
  running.set(name, draw);
  draw(null);
  box.querySelector("button")?.focus();
  let problem = "";
  try {
    const written = await api.clips.writeSession(clip, name, leaving.signal);
    h("a", { href: api.clips.session(clip, name), download: written.name }).click();
  } catch (error) {
    if (leaving.signal.aborted) toast("The session is cancelled", "Nothing was downloaded.");
    else
      problem = `The session could not be downloaded: ${error.message} Nothing is lost: try it again.`;
  } finally {
    running.delete(name);
  }
  drawStart(box, clip, problem);
}

/**
 * The element that exports a clip.
 *
 * @param {string} clip
 */
export function mcapExport(clip) {
  const known = elements.get(clip);
  if (known) return known;
  const box = h("span", { className: "mcap-export" });
  elements.set(clip, box);
  drawStart(box, clip, "");
  return box;
}

follow(["exporting"], () => {
  const { exporting } = state;
  if (exporting) running.get(exporting.id)?.(exporting);
});
