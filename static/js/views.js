// The views of the page: one is shown at a time, named in the URL, and loaded when first shown.

import { byId, h } from "./dom.js";
import { follow, state, update } from "./state.js";

/** The view at the start, which the URL does not name. */
const FIRST = "studio";

const VIEWS = [
  { name: FIRST, title: "Studio" },
];

const opened = new Map();

const nameOf = (view) => (VIEWS.some((each) => each.name === view) ? view : FIRST);

/** Show another view; `change` says what else is selected with it. */
export function go(view, change = {}) {
  update({ ...change, view: view === FIRST ? null : view });
}

/** The address of a view, for a link that can be copied or opened in another tab. */
function address(view) {
  const query = new URLSearchParams(location.search);
  if (view === FIRST) query.delete("view");
  else query.set("view", view);
  return `?${query}`;
}

function drawTabs(current) {
  byId("views").replaceChildren(...VIEWS.map(({ name, title }) => h("a", {
    href: address(name),
    "aria-current": name === current ? "page" : null,
    onclick: (event) => {
      if (event.ctrlKey || event.metaKey || event.shiftKey) return;
      event.preventDefault();
      go(name);
    },
  }, title)));
}

/** Show the view that is selected. */
async function show() {
  const current = nameOf(state.view);
  drawTabs(current);
  document.body.dataset.view = current;
  for (const { name } of VIEWS) byId(`view-${name}`).hidden = name !== current;
  const { load } = VIEWS.find((each) => each.name === current);
  if (!load || opened.has(current)) return;
  opened.set(current, true);
  const { open } = await load();
  open(byId(`view-${current}`));
}

/** Follow what is selected. A view's module exports `open(section)`, called when it is first shown. */
export function followViews() {
  follow(["view"], show);
}
