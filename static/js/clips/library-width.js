// The width of the library beside the clip: dragged or set by keys, and kept for all visits.

import { browserStore } from "../core/browser-store.js";
import { byId } from "../core/dom.js";

const KEY = "osg-studio.library-width";
const STEP = 20; // CSS pixels

/** @type {Record<string, number>} */
const KEYS = { ArrowLeft: -STEP, ArrowRight: STEP };

/** Bind the divider between library and clip, and show the width that was kept. */
export function bindLibraryWidth() {
  const divider = /** @type {HTMLElement} */ (byId("library-width"));
  const [narrowest, widest] = ["aria-valuemin", "aria-valuemax"].map((name) =>
    Number(divider.getAttribute(name)),
  );
  const width = () => byId("library").getBoundingClientRect().width;
  /** @param {number | null} wanted - null: as it was designed */
  function show(wanted) {
    const kept = wanted && Math.round(Math.min(widest, Math.max(narrowest, wanted)));
    byId("view-studio").style.setProperty("--library", kept ? `${kept}px` : "");
    divider.setAttribute("aria-valuenow", String(kept ?? Math.round(width())));
    return kept;
  }
  const set = (/** @type {number | null} */ wanted) => browserStore.write(KEY, show(wanted));
  divider.addEventListener("pointerdown", ({ pointerId }) => divider.setPointerCapture(pointerId));
  divider.addEventListener("pointermove", ({ clientX, pointerId }) => {
    if (divider.hasPointerCapture(pointerId)) set(clientX);
  });
  divider.addEventListener("dblclick", () => set(null));
  divider.addEventListener("keydown", (event) => {
    const step = KEYS[event.key];
    if (!step) return;
    event.preventDefault();
    event.stopPropagation();
    set(width() + step);
  });
  show(browserStore.read(KEY));
}
