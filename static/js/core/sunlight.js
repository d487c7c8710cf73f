// The look for direct sunlight: black on white with large targets, kept by the browser.

import { browserStore } from "./browser-store.js";
import { byId } from "./dom.js";
import { bind } from "./key-bindings.js";

const KEY = "osg-studio.look"; // A tablet on a boat stays as it was set.
const SUN = "sun";

/** @param {boolean} on */
function show(on) {
  if (on) document.documentElement.dataset.look = SUN;
  else delete document.documentElement.dataset.look;
  byId("sun").setAttribute("aria-pressed", String(on));
}

function toggle() {
  const on = document.documentElement.dataset.look !== SUN;
  show(on);
  browserStore.set(KEY, on ? SUN : null);
}

/** Bind the button in the header, and show the look that was chosen last. */
export function bindSun() {
  byId("sun").onclick = toggle;
  bind({ keys: ["Shift+L"], text: "Readable in the sun", group: "Everywhere", run: toggle });
  show(browserStore.get(KEY) === SUN);
}
