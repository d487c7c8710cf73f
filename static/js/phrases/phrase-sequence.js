// A phrase as a sequence of chips.

import { html, nothing } from "../templates.js";
import { grammar } from "./grammar-store.js";

/** @import { Phrase, PhrasePart } from "../core/types.d.ts" */

/** @param {Pick<PhrasePart, "least" | "most">} part */
const often = ({ least, most }) =>
  most === 1 ? "" : least === most ? ` \u00d7${most}` : ` \u00d7${Math.max(least, 1)}\u2013${most}`;

/**
 * @param {PhrasePart} part
 * @returns {unknown}
 */
function chip(part) {
  const optional = part.least === 0;
  const note = optional ? html`<span class="visually-hidden"> (may be left out)</span>` : nothing;
  const look = optional ? "optional" : "";
  const end = [often(part), note];
  if ("parts" in part)
    return html`<span class="chip-group ${look}">${part.parts.map(chip)}${end}</span>`;
  if ("slot" in part)
    return html`<span class="chip slot ${look}" title="a gesture of ${part.type}"
      >{${part.slot}}${end}</span
    >`;
  return html`<span class="chip ${look}">${part.gestures.join(" or ")}${end}</span>`;
}

/** @param {string | null} label */
const frame = (label) => (label ? html`<span class="chip frame">${label}</span>` : nothing);

/**
 * Draw a phrase with its start and end gestures.
 *
 * @param {Phrase} phrase
 */
export function sequence(phrase) {
  const { start, end } = grammar();
  return html`<span class="sequence">${frame(start)}${phrase.parts.map(chip)}${frame(end)}</span>`;
}
