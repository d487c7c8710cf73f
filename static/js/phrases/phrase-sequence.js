// A phrase as a sequence of chips.

import { h } from "../core/dom.js";
import { grammar } from "./grammar-store.js";

/** @import { Phrase, PhrasePart } from "../core/types.d.ts" */

/** @param {Pick<PhrasePart, "least" | "most">} part */
const often = ({ least, most }) =>
  most === 1 ? "" : least === most ? ` \u00d7${most}` : ` \u00d7${Math.max(least, 1)}\u2013${most}`;

/**
 * @param {PhrasePart} part
 * @returns {HTMLElement}
 */
function chip(part) {
  const optional = part.least === 0;
  const note = optional ? h("span", { className: "visually-hidden" }, " (may be left out)") : null;
  const look = optional ? " optional" : "";
  if ("parts" in part)
    return h("span", { className: `chip-group${look}` }, part.parts.map(chip), often(part), note);
  if ("slot" in part)
    return h(
      "span",
      { className: `chip slot${look}`, title: `a gesture of ${part.type}` },
      `{${part.slot}}`,
      often(part),
      note,
    );
  return h("span", { className: `chip${look}` }, part.gestures.join(" or "), often(part), note);
}

/** @param {string | null | undefined} label */
const frame = (label) => (label ? h("span", { className: "chip frame" }, label) : null);

/**
 * Draw a phrase with its start and end gestures.
 *
 * @param {Phrase} phrase
 */
export function sequence(phrase) {
  const { start, end } = grammar();
  return h(
    "span",
    { className: "sequence" },
    [frame(start), ...phrase.parts.map(chip), frame(end)].filter(Boolean),
  );
}
