// The list of clips in the library: each with its picture, its progress and its buttons.

import * as api from "../core/api.js";
import { byId } from "../core/dom.js";
import { state } from "../core/state.js";
import { attempt } from "../core/toasts.js";
import { recordAction, showDone } from "../core/undo.js";
import { guard, html, iconButtonOf, nothing, progressBar, render, repeat } from "../templates.js";
import { BUSY, queueOf } from "./batch.js";
import { countAll, forget, isListed, loadOlder, searchClips } from "./clip-pages.js";
import {
  hasPoster,
  needsTopic,
  offer,
  posterOf,
  reloadClip,
  select,
  statusText,
} from "./clip-store.js";
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
  if (state.clip === clip.id) offer((state.clips[at] ?? state.clips.at(-1))?.id ?? null);
  recordAction({ title: `Deletion of ${clip.name}`, kind: "clip", id: clip.id });
  showDone("Clip deleted", clip.name);
}

/** @param {Clip} clip */
async function retry(clip) {
  await attempt("Retrying", () => api.clips.retry(clip.id));
  await reloadClip(clip.id);
}

/**
 * The buttons of a clip, each with its name: another button must not take the place of one that is
 * being pressed.
 *
 * @param {Clip} clip
 * @returns {{ label: string, run: () => unknown, icon?: string }[]}
 */
function buttonsOf(clip) {
  const { name } = clip;
  const cancel = () => attempt("Cancelling", () => api.jobs.cancel(clip.job_id));
  if (BUSY.has(clip.status)) return [{ label: `Cancel ${name}`, run: cancel, icon: "close" }];
  const again = needsTopic(clip)
    ? [{ label: `Choose the topic of ${name}`, run: () => openTopics(clip) }]
    : clip.status === "done"
      ? []
      : [{ label: `Retry ${name}`, run: () => retry(clip), icon: "retry" }];
  return [...again, { label: `Delete ${name}`, run: () => remove(clip), icon: "trash" }];
}

/** @param {ReturnType<typeof buttonsOf>[number]} button */
const button = ({ label, run, icon }) =>
  icon
    ? iconButtonOf(icon, label, run, { writes: true })
    : html`<button type="button" class="choose-topic" data-writes aria-label=${label} @click=${run}>
        Choose…
      </button>`;

/**
 * @param {Clip} clip
 * @param {Job | undefined} job
 */
const progress = ({ name }, job) => progressBar(`Poses of ${name}`, job?.done, job?.total);

/** @param {Clip} clip */
function item(clip) {
  const { id, name, width, height, status } = clip;
  const job = state.jobs.get(clip.job_id);
  const chosen = id === state.clip;
  const stage = needsTopic(clip) ? "waiting" : status;
  const poster = guard([hasPoster(clip), api.clips.poster(clip)], () => posterOf(clip));
  return html`<li class="clip ${stage} ${chosen ? "chosen" : ""}">
    <button
      type="button"
      class="clip-open"
      title="${name}, ${width} × ${height} pixels"
      aria-pressed=${chosen}
      @click=${() => select(id)}
    >
      ${poster}<span class="clip-text"
        ><span class="visually-hidden">Show </span><b>${name}</b
        ><span class="stage-text">${statusText(clip, job)}</span>${
          status === "running" ? progress(clip, job) : nothing
        }</span
      >
    </button>
    <div class="clip-buttons">${repeat(buttonsOf(clip), ({ label }) => label, button)}</div>
  </li>`;
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
  render(
    repeat(inOrder, ({ id }) => id, item),
    list,
  );
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
