// The audit log for administrators: who changed what, and when, by name and day.

import * as api from "../core/api.js";
import { closeDialog, showDialog } from "../core/dialogs.js";
import { h } from "../core/dom.js";
import { dateAndTime } from "../core/format.js";
import { html, render } from "../templates.js";

/** @import { AuditEntry } from "../core/types.d.ts" */

const ENTRIES_OF_A_PAGE = 100;
const HEADS = ["Time", "Name", "Role", "Address", "Change", "Answer"];

/**
 * Return the query for these entries; both days are included in full, in the reader's time zone.
 *
 * @param {{ name: string, from: string, to: string }} wanted
 * @param {number} [before] id of the last entry on display
 * @returns {Record<string, string>}
 */
export function queryOf({ name, from, to }, before) {
  const until = to ? new Date(`${to}T00:00`) : null;
  until?.setDate(until.getDate() + 1);
  return {
    limit: String(ENTRIES_OF_A_PAGE),
    ...(name.trim() ? { name: name.trim() } : {}),
    ...(from ? { since: new Date(`${from}T00:00`).toISOString() } : {}),
    ...(until ? { until: until.toISOString() } : {}),
    ...(before ? { before: String(before) } : {}),
  };
}

/** @param {AuditEntry} entry */
function row(entry) {
  const { time, name, role, address, method, path, status, request_id } = entry;
  return html`<tr title="Request ${request_id}">
    <td><time datetime=${time} title=${time}>${dateAndTime(time)}</time></td>
    <td>${name || "\u2013"}</td>
    <td>${role}</td>
    <td>${address}</td>
    <td><code>${method} ${path}</code></td>
    <td class="num">${status}</td>
  </tr>`;
}

/**
 * @param {string} label
 * @param {string} type
 */
const field = (label, type) =>
  html`<div class="field">
    <label for="audit-${label.toLowerCase()}">${label}</label>
    <input
      type=${type}
      id="audit-${label.toLowerCase()}"
      name=${label.toLowerCase()}
      autocomplete="off"
    />
  </div>`;

/** Open the dialog with the newest changes. */
export function openAuditLog() {
  const form = h("form", { method: "dialog", className: "audit-log", noValidate: true });
  /** @type {AuditEntry[]} */
  let entries = [];
  let more = false; // whether older ones follow
  let note = "";
  let asked = 0;
  /** @param {number} [before] */
  const load = async (before) => {
    asked += 1;
    const request = asked;
    const wanted = /** @type {any} */ (Object.fromEntries(new FormData(form)));
    try {
      const found = await api.audit.list(queryOf(wanted, before));
      if (request !== asked) return;
      entries = before ? [...entries, ...found] : found;
      more = found.length === ENTRIES_OF_A_PAGE;
      note = entries.length ? "" : "Nobody has changed anything of that kind.";
    } catch (error) {
      if (request === asked) note = `The log could not be read: ${error.message}`;
    }
    draw();
  };
  const draw = () =>
    render(
      html`<h2 id="dialog-title">Audit log</h2>
        <div class="audit-filter">
          ${field("Name", "text")}${field("From", "date")}${field("To", "date")}
        </div>
        <div class="table-scroll" tabindex="0" role="region" aria-label="Changes">
          <table>
            <thead>
              <tr>
                ${HEADS.map((text) => html`<th scope="col">${text}</th>`)}
              </tr>
            </thead>
            <tbody>
              ${entries.map(row)}
            </tbody>
          </table>
        </div>
        <p class="dim" role="status">${note}</p>
        <div class="dialog-actions">
          <button type="button" ?hidden=${!more} @click=${() => load(entries.at(-1)?.id)}>
            Older changes
          </button>
          <span class="spacer"></span>
          <button type="button" @click=${closeDialog}>Close</button>
        </div>`,
      form,
    );
  form.onchange = () => load();
  form.onsubmit = (event) => event.preventDefault(); // Enter in a field triggers its change event.
  draw();
  showDialog(form);
  load();
}
