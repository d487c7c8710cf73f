// Reloading a list, or one member of it after the server reported a change: answers may come late.

import { attempt } from "./toasts.js";

/** @typedef {"clips" | "languages" | "takes"} List */

/** @type {Record<List, number>} */
const changes = { clips: 0, languages: 0, takes: 0 }; // so far

/**
 * Note a change of a list: what was requested of it before is outdated.
 *
 * @param {List} list
 */
export function outdate(list) {
  changes[list] += 1;
}

/**
 * Load a list by `load()`, again where it has changed meanwhile.
 *
 * @template T
 * @param {List} list
 * @param {() => Promise<T>} load
 * @returns {Promise<T>}
 */
export async function loadList(list, load) {
  const before = changes[list];
  const answer = await load();
  return before === changes[list] ? answer : loadList(list, load);
}

/** @type {Map<string, symbol>} */
const newest = new Map(); // the last request sent, by id

/**
 * Load a member by `load(id)`. Resolves to `{ member }`, with member null if it was deleted, or to
 * null if a newer request for it has been sent since.
 *
 * @template T
 * @param {string} id
 * @param {(id: string) => Promise<T>} load
 * @returns {Promise<{ member: T | null } | null>}
 */
async function loaded(id, load) {
  const request = Symbol(id);
  newest.set(id, request);
  const answer = await attempt("Loading what changed", async () => {
    try {
      return { member: await load(id) };
    } catch (error) {
      if (error.status === 404) return { member: null };
      throw error;
    }
  });
  if (newest.get(id) !== request) return null;
  newest.delete(id);
  return answer;
}

/**
 * Refresh a member of a list. `current()` returns its members and `order(one, other)` sorts them;
 * `take(list, member)` gets the new one.
 *
 * @template {{ id: string }} T
 * @template {T} M
 * @param {string} id
 * @param {{ list: List, load: (id: string) => Promise<M>, current: () => T[], order: (one: T, other: T) => number, take: (list: T[], member: M | null) => void }} source
 */
export async function refresh(id, { list, load, current, order, take }) {
  outdate(list);
  const answer = await loaded(id, load);
  if (!answer) return;
  const others = current().filter((each) => each.id !== id);
  take(answer.member ? [...others, answer.member].sort(order) : others, answer.member);
}
