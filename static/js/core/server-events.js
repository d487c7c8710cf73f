// The connection to the server: what changes there, and what is done when it was away.

import * as api from "./api.js";
import { followJob, reloadClip, reloadClips } from "../clips/clip-list.js";
import { byId } from "./dom.js";
import { reloadLanguages, reloadOneLanguage } from "../languages/language-store.js";
import { state, update } from "./state.js";
import { restart } from "../studio/workspace.js";

const RETRY = 1000; // ms, as the server asks of the browser

/** Hear of every change on the server; when that begins, also after a break, load what was missed. */
export function followServer(lost = false) {
  const stream = api.changes();
  let away = lost;
  const data = (event) => {
    try {
      return JSON.parse(event.data);
    } catch {
      return {};
    }
  };
  stream.onopen = () => {
    update({ connected: true });
    // What changed since everything was loaded was not heard of; nothing is sent twice.
    reloadClips();
    reloadLanguages();
    if (away) {
      restart();
      update({ returns: state.returns + 1 });
    }
    away = false;
  };
  stream.onerror = () => {
    away = true;
    update({ connected: false });
    // The browser tries again by itself, but not where somebody answered that nobody is there.
    if (stream.readyState === EventSource.CLOSED) setTimeout(followServer, RETRY, true);
  };
  stream.addEventListener("clips", (event) => reloadClip(data(event).id));
  stream.addEventListener("languages", (event) => reloadOneLanguage(data(event).id));
  stream.addEventListener("checks", (event) => update({ checking: data(event) }));
  stream.addEventListener("recognitions", (event) => update({ recognised: data(event).id }));
  stream.addEventListener("jobs", (event) => {
    const job = data(event);
    if (job.id) followJob(job);
  });
}

/** Say whether the server is there. */
export function drawConnection({ connected }) {
  const element = byId("connection");
  element.textContent =
    { true: "Connected", false: "Reconnecting\u2026" }[connected] ?? "Connecting\u2026";
  element.classList.toggle("on", connected === true);
  byId("away").hidden = connected !== false;
}
