// The list of clips in the library: each with its picture, its progress and its buttons.

import * as api from "../core/api.js";
import { byId, h, iconButton, reconcile, WRITES } from "../core/dom.js";
import { state } from "../core/state.js";
import { attempt } from "../core/toasts.js";
import { recordAction, showDone } from "../core/undo.js";
import { queueOf } from "./batch.js";
import { BUSY } from "./busy.js";
import { countAll, forget, isListed, loadOlder, searchClips } from "./clip-pages.js";
import { hasPoster, needsTopic, posterOf, reloadClip, select, statusText } from "./clip-store.js";
import { openTopics } from "./topic-dialog.js";

/** @import { Clip, Job, State } from "../core/types.d.ts" */

const SEEN_AT_ONCE = 6; // Clips visible without scrolling; with more, the search is shown.
let scrolling = false; // by the page itself
const TYPING = 200; // ms without a key before the server is asked
/**
 * The last name searched for, and the last clip of the result page if more follow.
 *
 * @type {{ text: string, last: string | null }}
 */
let searched = { text: "", last: null };
/** @type {string | null} */
let inView = null; // the clip that the list was last scrolled to

/** @param {Clip} clip */
async function remove(clip) {
  const done = await attempt("Deleting the clip", async () => {
    await api.clips.remove(clip.id);
    return true;
  });
  if (!done) return;
  const at = state.clips.findIndex(({ id }) => id === clip.id);
  forget(clip.id);
  // The focus moves to the next clip, which takes its place, as in every list.
  if (state.clip === clip.id) select((state.clips[at] ?? state.clips.at(-1))?.id ?? null);
  recordAction({ title: `Deletion of ${clip.name}`, kind: "clip", id: clip.id });
  showDone("Clip deleted", clip.name);
}

/** @param {Clip} clip */
async function retry(clip) {
  await attempt("Retrying", () => api.clips.retry(clip.id));
  await reloadClip(clip.id);
}

/** @param {Clip} clip */
function buttons(clip) {
  if (BUSY.has(clip.status))
    return [
      iconButton(
        "close",
        `Cancel ${clip.name}`,
        () => attempt("Cancelling", () => api.jobs.cancel(clip.job_id)),
        WRITES,
      ),
    ];
  const choose = needsTopic(clip)
    ? h(
        "button",
        {
          type: "button",
          className: "choose-topic",
          ...WRITES,
          "aria-label": `Choose the topic of ${clip.name}`,
          onclick: () => openTopics(clip),
        },
        "Choose\u2026",
      )
    : null;
  const again =
    clip.status === "done" || choose
      ? null
      : iconButton("retry", `Retry ${clip.name}`, () => retry(clip), WRITES);
  return [choose, again, iconButton("trash", `Delete ${clip.name}`, () => remove(clip), WRITES)];
}

/**
 * The value of a progress bar, if it is known.
 *
 * @param {Job} [job]
 */
const lengthOf = (job) => (job?.total ? { max: job.total, value: job.done } : {});

/**
 * Move the progress on in place.
 *
 * @param {HTMLElement} element
 * @param {Clip} clip
 * @param {Job} [job]
 */
function advance(element, clip, job) {
  /** @type {HTMLElement} */ (element.querySelector(".stage-text")).textContent = statusText(
    clip,
    job,
  );
  const bar = element.querySelector("progress");
  if (bar) Object.assign(bar, lengthOf(job));
}

/**
 * Replace an element's content; the button of the same name keeps the focus.
 *
 * @param {HTMLElement} element
 * @param {...(string | Node)} content
 */
function replaceKeepingFocus(element, ...content) {
  const { activeElement } = document;
  const name = element.contains(activeElement) ? activeElement?.getAttribute("aria-label") : null;
  element.replaceChildren(...content);
  if (!name) return;
  const named = /** @type {HTMLElement[]} */ ([...element.querySelectorAll("[aria-label]")]);
  named.find((each) => each.getAttribute("aria-label") === name)?.focus();
}

/**
 * @param {Clip} clip
 * @param {HTMLElement} [element]
 */
function draw(clip, element) {
  const job = state.jobs.get(clip.job_id);
  const busy = BUSY.has(clip.status);
  const chosen = clip.id === state.clip;
  const signature = JSON.stringify([clip, job, chosen, statusText(clip, job)]);
  if (element?.dataset.signature === signature) return element;
  // Progress comes ten times a second: a button must not be replaced under the pointer.
  const shape = JSON.stringify([clip, chosen, hasPoster(clip)]);
  if (busy && element?.dataset.shape === shape) {
    element.dataset.signature = signature;
    advance(element, clip, job);
    return element;
  }
  const drawn = element ?? h("li");
  drawn.dataset.signature = signature;
  drawn.dataset.shape = shape;
  drawn.className = `clip ${needsTopic(clip) ? "waiting" : clip.status}${chosen ? " chosen" : ""}`;
  replaceKeepingFocus(
    drawn,
    h(
      "button",
      {
        type: "button",
        className: "clip-open",
        title: `${clip.name}, ${clip.width} \u00d7 ${clip.height} pixels`,
        "aria-pressed": String(chosen),
        onclick: () => select(clip.id),
      },
      posterOf(clip, element?.querySelector(".poster:not(.blank)")),
      h(
        "span",
        { className: "clip-text" },
        h("span", { className: "visually-hidden" }, "Show "),
        h("b", {}, clip.name),
        h("span", { className: "stage-text" }, statusText(clip, job)),
        clip.status === "running"
          ? h("progress", { "aria-label": `Poses of ${clip.name}`, ...lengthOf(job) })
          : null,
      ),
    ),
    h("div", { className: "clip-buttons" }, buttons(clip)),
  );
  return drawn;
}

/** @param {State} state */
export function drawClips(state) {
  const { clips, clip: chosen } = state;
  byId("clip-count").textContent = clips.length ? countAll(state).toLocaleString() : "";
  const search = byId("find-clip");
  search.hidden = clips.length <= SEEN_AT_ONCE;
  const wanted = search.hidden ? "" : search.value.trim().toLowerCase();
  const shown = clips.filter((clip) =>
    wanted ? clip.name.toLowerCase().includes(wanted) : isListed(clip, state) || clip.id === chosen,
  );
  const list = byId("clips");
  // Those that are worked on come first, in the order of the work.
  const worked = [...shown.filter(({ status }) => status === "running"), ...queueOf(shown)];
  const inOrder = [...worked, ...shown.filter(({ status }) => !BUSY.has(status))];
  reconcile(list, inOrder, (clip) => clip.id, draw);
  drawMore(state, wanted);
  byId("no-clip").textContent =
    clips.length && !shown.length && searched.text === wanted
      ? `No clip is called \u201c${search.value.trim()}\u201d.`
      : "";
  if (chosen !== inView && list.clientHeight) bringIntoView(list, chosen);
}

/**
 * Show the button that loads more clips, of all or of those that are found.
 *
 * @param {State} state
 * @param {string} wanted
 */
function drawMore({ library }, wanted) {
  const more = byId("more-clips");
  more.hidden = wanted ? searched.text !== wanted || !searched.last : !library.last;
  more.textContent = wanted
    ? "More clips of this name"
    : `Older clips (${library.older.toLocaleString()})`;
}

/**
 * Search for a name on the server if not all clips are known.
 *
 * @param {string} text
 * @param {string} [after]
 */
async function search(text, after) {
  const page =
    text && state.library.last ? await searchClips(text, after) : { clips: [], more: false };
  if (!page || text !== wantedName()) return; // The text has changed since.
  searched = { text, last: page.more ? (page.clips.at(-1)?.id ?? null) : null };
  drawClips(state);
}

const wantedName = () => byId("find-clip").value.trim().toLowerCase();

/** Load the clips that follow those in the list. */
function loadMore() {
  if (wantedName()) return search(wantedName(), searched.last ?? undefined);
  return loadOlder();
}

/**
 * Scroll the list, and nothing else, to the clip on display.
 *
 * @param {HTMLElement} list
 * @param {string | null} chosen
 */
function bringIntoView(list, chosen) {
  /** @type {HTMLElement | null} */
  const item = list.querySelector(".chosen");
  if (!item) return;
  inView = chosen;
  const top = item.offsetTop - list.offsetTop;
  const left = item.offsetLeft - list.offsetLeft;
  const seen =
    top >= list.scrollTop &&
    top + item.offsetHeight <= list.scrollTop + list.clientHeight &&
    left >= list.scrollLeft &&
    left + item.offsetWidth <= list.scrollLeft + list.clientWidth;
  if (!seen) {
    scrolling = true;
    list.scrollTop = top - (list.clientHeight - item.offsetHeight) / 2;
    list.scrollLeft = left - (list.clientWidth - item.offsetWidth) / 2;
  }
}

/** Bind the search for clips by name. */
export function findClips() {
  let typed = 0;
  byId("find-clip").oninput = () => {
    inView = null; // The clip on display has another place in the results.
    if (state.library.last) {
      clearTimeout(typed);
      typed = setTimeout(() => search(wantedName()), TYPING);
    } else searched = { text: wantedName(), last: null };
    drawClips(state);
  };
  byId("more-clips").onclick = loadMore;
  const list = byId("clips");
  list.onscroll = () => {
    // Scrolling by the page loads no clips, even if the clip on display is the last one loaded.
    const byItself = scrolling;
    scrolling = false;
    if (byItself) return;
    // On a phone the list is a strip, which ends at the right.
    const below = list.scrollHeight - list.scrollTop - list.clientHeight;
    const beside = list.scrollWidth - list.scrollLeft - list.clientWidth;
    const near = Math.max(list.clientHeight, list.clientWidth);
    if (below + beside < near && !wantedName()) loadOlder();
  };
}
