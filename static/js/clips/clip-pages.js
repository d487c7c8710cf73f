// The clips loaded so far from a library that may hold many more; they are loaded in pages.

import * as api from "../core/api.js";
import { loadList } from "../core/list-refresh.js";
import { state, update } from "../core/state.js";
import { attempt } from "../core/toasts.js";
import { BUSY } from "./batch.js";
import { clipsOfDemonstrations } from "./demonstration-ranges.js";

/** @import { Clip, ClipPage, State } from "../core/types.d.ts" */

const NAMED_AT_ONCE = 100; // ids in one address

/** @type {Set<string>} */
const named = new Set(); // clips that were requested by id
/** @type {Set<string>} */
let found = new Set(); // clips that the last search found

/**
 * The order of all lists of clips.
 *
 * @param {Pick<Clip, "id" | "created">} one
 * @param {Pick<Clip, "id" | "created">} other
 */
export const newestFirst = (one, other) =>
  other.created.localeCompare(one.created) || one.id.localeCompare(other.id);

/**
 * Whether a clip belongs to the part of the library that is loaded without gaps.
 *
 * @param {Clip} clip
 * @param {Pick<State, "library">} state
 */
export const isListed = (clip, { library: { last } }) => !last || newestFirst(clip, last) <= 0;

/**
 * The number of all clips.
 *
 * @param {Pick<State, "clips" | "library">} known
 */
export const countAll = (known) =>
  known.clips.filter((clip) => isListed(clip, known)).length + known.library.older;

/**
 * Merge two lists of clips; of duplicates the one loaded last is kept.
 *
 * @param {Clip[]} clips
 * @param {Clip[]} loaded
 */
export const merged = (clips, loaded) =>
  [...new Map([...clips, ...loaded].map((clip) => [clip.id, clip])).values()].sort(newestFirst);

/**
 * Load clips by their ids; deleted ones are left out.
 *
 * @param {string[]} ids
 */
async function loadNamed(ids) {
  /** @type {Clip[]} */
  const loaded = [];
  for (let at = 0; at < ids.length; at += NAMED_AT_ONCE) {
    const page = await api.clips.page({ id: ids.slice(at, at + NAMED_AT_ONCE) });
    loaded.push(...page.clips);
  }
  return loaded;
}

/**
 * Load the newest clips, as many as were listed before, and also those that are busy, on display,
 * found by the last search or referred to by id.
 */
async function loadKnown() {
  const wanted = state.clips.filter((clip) => isListed(clip, state)).length;
  let page = await api.clips.page();
  const { total } = page;
  let { clips } = page;
  while (page.more && clips.length < wanted) {
    page = await api.clips.page({ after: /** @type {Clip} */ (clips.at(-1)).id });
    clips = [...clips, ...page.clips];
  }
  if (!page.more) return { clips, library: { last: null, older: 0 } };
  const last = clips.at(-1) ?? null;
  const listed = new Set(clips.map(({ id }) => id));
  const ids = [...new Set([...named, ...found, state.clip])].filter(
    (id) => id !== null && !listed.has(id),
  );
  const busy = await api.clips.page({ status: [...BUSY] });
  const others = [...busy.clips, ...(await loadNamed(/** @type {string[]} */ (ids)))];
  return { clips: merged(others, clips), library: { last, older: total - listed.size } };
}

/** @type {Promise<unknown>} */
let turn = Promise.resolve();

/**
 * Load parts of the list one after another: each continues where the previous one ended, and a
 * reload of the whole list cannot discard a part that arrived meanwhile.
 *
 * @template T
 * @param {() => Promise<T>} load
 * @returns {Promise<T>}
 */
function inTurn(load) {
  const loaded = turn.then(load, load);
  turn = loaded;
  return loaded;
}

/** Load the clips; resolves to whether that succeeded. */
export const reloadClips = () =>
  inTurn(async () => {
    const known = await attempt("Loading the clips", () => loadList("clips", loadKnown));
    if (known) update(known);
    return known !== null;
  });

/**
 * Load one clip that was added; resolves to the clip.
 *
 * @param {string} id
 */
export const loadClip = (id) =>
  inTurn(async () => {
    const clip = await api.clips.get(id);
    take(clip);
    return clip;
  });

/**
 * Add a clip to the state.
 *
 * @param {Clip} clip
 */
export const take = (clip) => update({ clips: merged(state.clips, [clip]) });

/**
 * Remove a deleted clip from the state.
 *
 * @param {string} id
 */
export const forget = (id) => update({ clips: state.clips.filter((clip) => clip.id !== id) });

/** @type {Promise<void> | null} */
let loading = null;

/** Load the page of clips after those listed. */
export function loadOlder() {
  loading ??= inTurn(loadNext).finally(() => {
    loading = null;
  });
  return loading;
}

async function loadNext() {
  const { last, older } = state.library;
  if (!last) return;
  /** @type {ClipPage | null} */
  const page = await attempt("Loading older clips", () => api.clips.page({ after: last.id }));
  if (!page) return;
  update({
    clips: merged(state.clips, page.clips),
    library: {
      last: page.more ? (page.clips.at(-1) ?? null) : null,
      older: page.more ? Math.max(0, older - page.clips.length) : 0,
    },
  });
}

/**
 * Search the server for clips whose name contains `text`, starting after the clip `after` if given;
 * adds the page of results to the state and resolves to it.
 *
 * @param {string} text
 * @param {string} [after]
 */
export const searchClips = (text, after) =>
  inTurn(async () => {
    const page = await attempt("Looking for clips", () =>
      api.clips.page(after ? { q: text, after } : { q: text }),
    );
    if (!page) return null;
    found = new Set([...(after ? found : []), ...page.clips.map(({ id }) => id)]);
    update({ clips: merged(state.clips, page.clips) });
    return page;
  });

/**
 * Load the clips with these ids that are not loaded yet.
 *
 * @param {Iterable<string | null | undefined>} ids
 */
export async function knowClips(ids) {
  if (!state.library.last) return;
  const known = new Set(state.clips.map(({ id }) => id));
  const missing = [...new Set(ids)].filter((id) => id && !known.has(id) && !named.has(id));
  if (!missing.length) return;
  for (const id of missing) named.add(/** @type {string} */ (id));
  await inTurn(async () => {
    const loaded = await attempt("Loading the clips", () =>
      loadNamed(/** @type {string[]} */ (missing)),
    );
    if (loaded?.length) update({ clips: merged(state.clips, loaded) });
  });
}

/**
 * Load the clips that the page refers to: the one on display, those waiting for the test, and the
 * sources of the demonstrations.
 *
 * @param {Pick<State, "clip" | "pending" | "gestures">} state
 */
export const knowReferences = ({ clip, pending, gestures }) =>
  knowClips([clip, ...pending.map((each) => each.clip), ...clipsOfDemonstrations(gestures)]);
