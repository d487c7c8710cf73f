// The keyboard: one list of what every key does, which is also what `?` shows.

import { byId, h } from "./dom.js";

const bound = [];

const TYPED_IN =
  "input:not([type=range]):not([type=checkbox]):not([type=radio]), textarea, select, [contenteditable=true]";

/**
 * Let a key do something. `keys` are as people read them, "Ctrl+Shift+Z" or "Shift+,", the first
 * is the one told; `when` says whether it means anything now, and of several that do the last one
 * bound is meant. Plain keys are left alone where text
 * is typed. None may shadow what the browser itself does.
 */
export function bind({ keys, text, group, run, when = () => true }) {
  bound.push({ keys, text, group, run, when });
}

/** A key press as it is written in `bind`; what Shift makes of a letter or sign is undone. */
function written(event) {
  const name =
    event.key === " "
      ? "Space"
      : event.code.startsWith("Key")
        ? event.code.slice(3)
        : ({ Comma: ",", Period: ".", BracketLeft: "[", BracketRight: "]" }[event.code] ??
          event.key);
  const held = [
    event.ctrlKey || event.metaKey ? "Ctrl" : "",
    event.altKey ? "Alt" : "",
    event.shiftKey && event.key !== "?" ? "Shift" : "",
  ];
  return [...held.filter(Boolean), name].join("+");
}

let opening = null; // A view that is being loaded: its keys are not bound yet.

/** Let keys that are pressed before a promise is kept wait for it. */
export function holdKeys(promise) {
  opening = promise;
  promise.finally(() => {
    if (opening === promise) opening = null;
  });
}

const meant = (combination) =>
  bound.findLast((each) => each.keys.includes(combination) && each.when());

function pressed(event) {
  if (event.defaultPrevented || document.querySelector("dialog[open]")) return;
  // An element of a frame is no Element of this window.
  const at = event.target?.closest ? event.target : null;
  if (at?.closest(TYPED_IN)) return;
  // A button that has the focus is pressed with the space bar.
  if (event.key === " " && at?.closest("button, summary, [role=tab], [role=button]")) return;
  const combination = written(event);
  if (opening) {
    if (event.key === " ") event.preventDefault(); // It would scroll the page.
    opening.then(() => meant(combination)?.run(event));
    return;
  }
  const found = meant(combination);
  if (!found) return;
  event.preventDefault();
  found.run(event);
}

const keyCaps = (combination) => combination.split("+").map((key) => h("kbd", {}, key));

let loadAll = async () => {};

/** Let `load()` bring the modules that bind keys and were not needed so far, before all are told. */
export const loadBeforeTelling = (load) => {
  loadAll = load;
};

/** Write the keys that are bound by now, by what they belong to. */
function drawKeys(list) {
  const groups = [...new Set(bound.map((each) => each.group))];
  list.replaceChildren(
    ...groups.map((group) =>
      h(
        "section",
        {},
        h("h3", {}, group),
        h(
          "dl",
          {},
          bound
            .filter((each) => each.group === group)
            .map((each) =>
              h("div", {}, h("dt", {}, keyCaps(each.keys[0])), h("dd", {}, each.text)),
            ),
        ),
      ),
    ),
  );
}

/** Show all keys: those known here at once, and those of views that were not opened as they come. */
export function showKeys() {
  const dialog = byId("dialog");
  const list = h("div", { className: "key-groups" });
  drawKeys(list);
  loadAll().then(() => drawKeys(list));
  dialog.replaceChildren(
    h(
      "div",
      { className: "key-list" },
      h("h2", { id: "dialog-title" }, "Keys"),
      list,
      h(
        "div",
        { className: "dialog-actions" },
        h(
          "button",
          {
            type: "button",
            onclick: () => {
              dialog.close();
              import("../studio/tour.js").then(({ startTour }) => startTour());
            },
          },
          "Tour",
        ),
        h(
          "button",
          { type: "button", className: "primary", autofocus: true, onclick: () => dialog.close() },
          "Close",
        ),
      ),
    ),
  );
  dialog.setAttribute("aria-labelledby", "dialog-title");
  dialog.onclose = null;
  dialog.showModal();
}

/** Hear the keys that are pressed in a window: this one, or a frame in it. */
export function listenToKeys(heard = window) {
  heard.addEventListener("keydown", pressed);
}

bind({ keys: ["?"], text: "Show all keys", group: "Everywhere", run: showKeys });
