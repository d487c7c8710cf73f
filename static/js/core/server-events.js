// The stream of server-sent events: what changes on the server, and whether it can be reached.

import * as api from "./api.js";
import { byId } from "./dom.js";
import { state, update } from "./state.js";

/** @import { Job, State } from "./types.d.ts" */

const RETRY = 1000; // ms, as the server asks of the browser

/**
 * Listen to every change on the server. `handlers` has a function per kind of event, `clips(id)`,
 * `languages(id)` and `jobs(job)`; `opened()`, which loads what was missed, is called whenever the
 * stream opens, and `returned()` when it opens after a break.
 *
 * @param {{ opened: () => void, returned: () => void, clips: (id: string) => void, languages: (id: string) => void, jobs: (job: Job) => void }} handlers
 * @param {boolean} [lost]
 */
export function followServer(handlers, lost = false) {
  const stream = api.changes();
  let away = lost;
  /** @param {MessageEvent} event */
  const data = (event) => {
    try {
      return JSON.parse(event.data);
    } catch {
      return {};
    }
  };
  stream.onopen = () => {
    update({ connected: true });
    // The server sends no event twice: what changed since everything was loaded is loaded again.
    handlers.opened();
    if (away) {
      handlers.returned();
      update({ returns: state.returns + 1 });
    }
    away = false;
  };
  stream.onerror = () => {
    away = true;
    update({ connected: false });
    // The browser reconnects by itself, but not after an HTTP error, such as a proxy's 502.
    if (stream.readyState === EventSource.CLOSED) setTimeout(followServer, RETRY, handlers, true);
  };
  stream.addEventListener("clips", (event) => handlers.clips(data(event).id));
  stream.addEventListener("languages", (event) => handlers.languages(data(event).id));
  stream.addEventListener("checks", (event) => update({ checking: data(event) }));
  stream.addEventListener("exports", (event) => update({ exporting: data(event) }));
  stream.addEventListener("tables", (event) => update({ tabling: data(event) }));
  stream.addEventListener("test-sets", (event) => update({ labelled: { id: data(event).id } }));
  stream.addEventListener("tests", (event) => {
    const run = data(event);
    // The end of a run is its answer's; a late event must not show it as running again.
    if (state.testing?.id === run.id) update({ testing: run });
  });
  stream.addEventListener("jobs", (event) => {
    const job = data(event);
    if (job.id) handlers.jobs(job);
  });
}

/**
 * Show whether the server can be reached.
 *
 * @param {State} state
 */
export function drawConnection({ connected }) {
  const element = byId("connection");
  if (connected === null) element.textContent = "Connecting\u2026";
  else element.textContent = connected ? "Connected" : "Reconnecting\u2026";
  element.classList.toggle("on", connected === true);
  byId("away").hidden = connected !== false;
}
