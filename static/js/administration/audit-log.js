// The audit log for administrators: who changed what, and when, by name and day.

import * as api from "../core/api.js";
import { byId, h } from "../core/dom.js";
import { dateAndTime } from "../core/format.js";

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
  return h(
    "tr",
    { title: `Request ${request_id}` },
    h("td", {}, h("time", { dateTime: time, title: time }, dateAndTime(time))),
    [name || "\u2013", role, address].map((text) => h("td", {}, text)),
    h("td", {}, h("code", {}, `${method} ${path}`)),
    h("td", { className: "num" }, String(status)),
  );
}

/**
 * @param {string} label
 * @param {string} type
 */
const input = (label, type) =>
  h("input", { type, id: `audit-${label.toLowerCase()}`, autocomplete: "off" });

/** @param {HTMLInputElement} control @param {string} label */
const field = (control, label) =>
  h("div", { className: "field" }, h("label", { for: control.id }, label), control);

/** Open the dialog with the newest changes. */
export function openAuditLog() {
  const dialog = byId("dialog");
  const [name, from, to] = [input("Name", "text"), input("From", "date"), input("To", "date")];
  const body = h("tbody");
  const note = h("p", { className: "dim", role: "status" });
  const more = h("button", { type: "button", hidden: true }, "Older changes");
  let asked = 0;
  let last = 0; // id of the last entry on display
  /** @param {number} [before] */
  const load = async (before) => {
    asked += 1;
    const request = asked;
    const wanted = { name: name.value, from: from.value, to: to.value };
    try {
      const found = await api.audit.list(queryOf(wanted, before));
      if (request !== asked) return;
      if (!before) body.replaceChildren();
      body.append(...found.map(row));
      last = found.at(-1)?.id ?? last;
      more.hidden = found.length < ENTRIES_OF_A_PAGE;
      note.textContent = body.children.length ? "" : "Nobody has changed anything of that kind.";
    } catch (error) {
      if (request === asked) note.textContent = `The log could not be read: ${error.message}`;
    }
  };
  more.onclick = () => load(last);
  const table = h(
    "table",
    {},
    h(
      "thead",
      {},
      h(
        "tr",
        {},
        HEADS.map((text) => h("th", { scope: "col" }, text)),
      ),
    ),
    body,
  );
  const form = h(
    "form",
    { method: "dialog", className: "audit-log", noValidate: true },
    h("h2", { id: "dialog-title" }, "Audit log"),
    h(
      "div",
      { className: "audit-filter" },
      field(name, "Name"),
      field(from, "From"),
      field(to, "To"),
    ),
    h(
      "div",
      { className: "table-scroll", tabIndex: 0, role: "region", "aria-label": "Changes" },
      table,
    ),
    note,
    h(
      "div",
      { className: "dialog-actions" },
      more,
      h("span", { className: "spacer" }),
      h("button", { type: "button", onclick: () => dialog.close() }, "Close"),
    ),
  );
  form.onchange = () => load();
  form.onsubmit = (event) => event.preventDefault(); // Enter in a field triggers its change event.
  dialog.replaceChildren(form);
  dialog.setAttribute("aria-labelledby", "dialog-title");
  dialog.onclose = null;
  dialog.showModal();
  load();
}
