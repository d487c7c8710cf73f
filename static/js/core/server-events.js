// The stream of server-sent events: what changes on the server, and whether it can be reached.

import * as api from "./api.js";
import { byId } from "./dom.js";
import { state, update } from "./state.js";

/** @import { Job, State } from "./types.d.ts" */

/** @typedef {{ opened: () => void, returned: () => void, seen: () => void, clips: (id: string) => void, languages: (id: string) => void, jobs: (job: Job) => void }} Handlers */

const RETRY = 1000; // ms, `RETRY_MILLISECONDS` of api/routes/events.py
const UNSEEN = 30_000; // ms after which a hidden page closes its connection

/** @type {EventSource | null} */
let current = null; // null while the page is hidden

/**
 * Listen to every change on the server. `handlers` has a function per kind of event: `clips(id)`,
 * `languages(id)` and `jobs(job)`. `opened()`, which loads missed changes, is called whenever the
 * stream opens, `returned()` when it opens after a break, and `seen()` when it opens because the
 * page is visible again. A browser has six connections to a server for all its tabs, so a tab in
 * the background keeps none.
 *
 * @param {Handlers} handlers
 */
export function followServer(handlers) {
  let unseen = 0;
  const leaveLater = () => {
    unseen = setTimeout(() => {
      // A page in the background, too, tests its clips that wait for the test set.
      if (state.pending.length) leaveLater();
      else {
        current?.close();
        current = null;
      }
    }, UNSEEN);
  };
  const look = () => {
    clearTimeout(unseen);
    if (document.hidden) leaveLater();
    else if (!current) listen(handlers, handlers.seen);
  };
  document.addEventListener("visibilitychange", look);
  listen(handlers);
  look();
}

/**
 * Whether the session has ended, here or by a log-out elsewhere: it does not come back, and the
 * server then shows the page to sign in.
 */
const isSignedOut = () =>
  api.session.get().then(
    () => false,
    (error) => error.status === 401,
  );

/**
 * @param {Handlers} handlers
 * @param {() => void} [after]  what to do after a break, once the stream opens
 */
function listen(handlers, after) {
  const stream = api.changes();
  current = stream;
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
    // The server repeats no event, so everything is loaded again after a break.
    handlers.opened();
    if (after) {
      after();
      update({ returns: state.returns + 1 });
    }
    after = undefined;
  };
  stream.onerror = () => {
    after = handlers.returned;
    update({ connected: false });
    // The browser reconnects by itself, but not after an HTTP error, such as a proxy's 502.
    if (stream.readyState === EventSource.CLOSED)
      setTimeout(async () => {
        const signedOut = current === stream && (await isSignedOut());
        if (current !== stream) return;
        if (signedOut) location.assign("./");
        else listen(handlers, handlers.returned);
      }, RETRY);
  };
  stream.addEventListener("clips", (event) => handlers.clips(data(event).id));
  stream.addEventListener("languages", (event) => handlers.languages(data(event).id));
  stream.addEventListener("checks", (event) => update({ checking: data(event) }));
  stream.addEventListener("exports", (event) => update({ exporting: data(event) }));
  stream.addEventListener("tables", (event) => update({ tabling: data(event) }));
  stream.addEventListener("test-sets", (event) => update({ labelled: { id: data(event).id } }));
  stream.addEventListener("tests", (event) => {
    const run = data(event);
    // The answer to the request ends a run; a late event must not show it as running again.
    if (state.testing?.id === run.id) update({ testing: run });
  });
  stream.addEventListener("jobs", (event) => {
    const job = data(event);
    if (job.status) handlers.jobs(job);
    // Of a deleted clip there is no job any more.
    else if (job.clip_id) handlers.clips(job.clip_id);
  });
}

/**
 * Show whether the server can be reached.
 *
 * @param {State} state
 */
export function drawConnection({ connected }) {
  const element = byId("connection");
  const missing = connected === null ? "Connecting\u2026" : "Reconnecting\u2026";
  element.textContent = connected ? "Connected" : missing;
  element.classList.toggle("on", connected === true);
  byId("away").hidden = connected !== false;
}
