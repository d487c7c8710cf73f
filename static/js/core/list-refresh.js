// Reloading a list, or one member of it after the server reported a change: answers may come late.

import { attempt } from "./toasts.js";

let changes = 0; // Members reported so far; a list requested before the last one is outdated.

/**
 * Load a list by `load()`, again where a member has changed meanwhile.
 *
 * @template T
 * @param {() => Promise<T>} load
 * @returns {Promise<T>}
 */
export async function loadList(load) {
  const before = changes;
  const list = await load();
  return before === changes ? list : loadList(load);
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
 * Refresh a member of a list. `current()` returns the list and `order(one, other)` sorts it;
 * `take(list, member)` gets the new one.
 *
 * @template {{ id: string }} T
 * @template {T} M
 * @param {string} id
 * @param {{ load: (id: string) => Promise<M>, current: () => T[], order: (one: T, other: T) => number, take: (list: T[], member: M | null) => void }} source
 */
export async function refresh(id, { load, current, order, take }) {
  changes += 1;
  const answer = await loaded(id, load);
  if (!answer) return;
  const others = current().filter((each) => each.id !== id);
  take(answer.member ? [...others, answer.member].sort(order) : others, answer.member);
}
