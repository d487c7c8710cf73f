// Links of a finding: to the editor of a gesture, or to two gestures side by side.

import { state, update } from "../core/state.js";
import { html, nothing } from "../templates.js";
import { address, go, here, knows } from "../core/views.js";

/**
 * Two labels as they are in the address, separated by a comma; commas in labels are escaped.
 *
 * @param {string} one
 * @param {string} other
 */
export const pairName = (one, other) => [one, other].map(encodeURIComponent).join(",");

/**
 * The two labels that `name` names, if there are two.
 *
 * @param {string | null} name
 * @returns {[string, string] | null}
 */
export function pairOf(name) {
  const labels = (name ?? "").split(",");
  if (labels.length !== 2) return null;
  try {
    return [decodeURIComponent(labels[0]), decodeURIComponent(labels[1])];
  } catch {
    return null;
  }
}

/**
 * Show two gestures side by side.
 *
 * @param {string} one
 * @param {string} other
 */
export const compare = (one, other) => update({ pair: pairName(one, other) });

/**
 * A link to the editor of a gesture; nothing where the language has no such gesture.
 *
 * @param {string} label
 * @param {string} [text]
 */
export function editLink(label, text = `Edit ${label}`) {
  if (!knows("gesture") || !state.gestures?.labels.includes(label)) return nothing;
  return html`<a
    class="button"
    title=${text}
    href=${address("gesture", { gesture: label })}
    @click=${here(() => go("gesture", { gesture: label }))}
    >${text}</a
  >`;
}
