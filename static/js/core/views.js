// The views of the page: one is shown at a time, named in the URL, and imported when first shown.

import { html, ifDefined, render, repeat } from "../templates.js";
import { byId } from "./dom.js";
import { holdKeys } from "./key-bindings.js";
import { follow, state, update } from "./state.js";

/** @import { State, View } from "./types.d.ts" */

/** The view at the start, which the URL does not name. */
const FIRST = "studio";

/** @type {View[]} */
let views = []; // `{ name, title, load, passing }`

/** @type {Map<string, Promise<void>>} */
const opened = new Map();
/** @type {Map<string, () => boolean | Promise<boolean>>} */
const guards = new Map();

/**
 * Register `mayLeave()`, which is awaited before the view is left for another one.
 *
 * @param {string} view
 * @param {() => boolean | Promise<boolean>} mayLeave
 */
export const guard = (view, mayLeave) => guards.set(view, mayLeave);

/** @param {string | null} view */
const nameOf = (view) => (view !== null && knows(view) ? view : FIRST);

/** @param {string} view */
const mayLeave = async (view) => (await guards.get(view)?.()) ?? true;

/**
 * Show another view; `change` says what else is selected with it.
 *
 * @param {string | null} view
 * @param {Partial<State>} [change]
 */
export async function go(view, change = {}) {
  const current = nameOf(state.view);
  if (nameOf(view) !== current && !(await mayLeave(current))) return;
  update({ ...change, view: view === FIRST ? null : view });
}

/**
 * Whether there is a view of that name.
 *
 * @param {string | null} view
 */
export const knows = (view) => views.some((each) => each.name === view);

/**
 * The address of a view, for a link that can be copied or opened in another tab.
 *
 * @param {string} view
 * @param {Record<string, any>} [change]
 */
export function address(view, change = {}) {
  const query = new URLSearchParams(location.search);
  for (const [name, value] of Object.entries(change)) {
    if (value === null) query.delete(name);
    else query.set(name, value);
  }
  if (view === FIRST) query.delete("view");
  else query.set("view", view);
  return `?${query}`;
}

/**
 * The click handler of a link: a plain click calls `run`; the browser opens other tabs and windows.
 *
 * @param {() => unknown} run
 * @returns {(event: MouseEvent) => void}
 */
export const here = (run) => (event) => {
  if (event.ctrlKey || event.metaKey || event.shiftKey) return;
  event.preventDefault();
  run();
};

/**
 * Draw the tabs; a link that has the focus keeps it.
 *
 * @param {string} current
 */
function drawTabs(current) {
  const shown = views.filter(({ name, passing }) => !passing || name === current);
  const tab = (/** @type {View} */ { name, title }) =>
    html`<a
      href=${address(name)}
      aria-current=${ifDefined(name === current ? "page" : undefined)}
      @click=${here(() => go(name))}
      >${title}</a
    >`;
  render(
    repeat(shown, ({ name }) => name, tab),
    byId("views"),
  );
}

/** Scroll the row of tabs, on a phone, to the one that is selected. */
function revealTab() {
  const tabs = byId("views");
  /** @type {HTMLElement | null} */
  const tab = tabs.querySelector("[aria-current]");
  if (tab) tabs.scrollLeft = tab.offsetLeft - (tabs.clientWidth - tab.offsetWidth) / 2;
}

/** Show the view that is selected. */
async function show() {
  const current = nameOf(state.view);
  drawTabs(current);
  revealTab();
  document.body.dataset.view = current;
  for (const { name } of views) byId(`view-${name}`).hidden = name !== current;
  const load = views.find((each) => each.name === current)?.load;
  if (!load || opened.has(current)) return;
  const loading = load().then(({ open }) => open(byId(`view-${current}`)));
  opened.set(current, loading);
  holdKeys(loading);
  await loading;
}

/** Load the modules of all views, also of those not opened yet. */
export const loadViews = () => Promise.allSettled(views.map(({ load }) => load?.()));

/**
 * Show the selected view of `list`. `load()` imports the view's module, which exports
 * `open(section)`, called when the view is first shown. A passing view has a tab only while it is
 * open, since it has nothing to show otherwise.
 *
 * @param {View[]} list
 */
export function followViews(list) {
  views = list;
  follow(["view"], show);
}
