// The findings, the worst first, each with links to where it can be mended.

import { h } from "../core/dom.js";
import { go } from "../core/views.js";
import { compare, editLink } from "./finding-links.js";
import { changeButton } from "./replacements.js";

/** @import { Finding } from "../core/types.d.ts" */

const AT_FIRST = 5; // Findings shown before the table and the map; the worst come first.

/**
 * @param {Finding} finding
 * @param {boolean} compared whether its gestures stand side by side already
 */
function finding({ kind, gestures, message, error }, compared) {
  const [one, other] = gestures;
  const two = gestures.length === 2 && !compared;
  return h(
    "li",
    { className: `finding ${error ? "error" : "note"}` },
    h("span", { className: "mark", "aria-hidden": "true" }, error ? "!" : "i"),
    h(
      "div",
      { className: "finding-text" },
      h("p", {}, h("b", {}, error ? "Error: " : "Note: "), message),
      h(
        "div",
        { className: "finding-links" },
        kind.startsWith("phrases_")
          ? h("button", { type: "button", onclick: () => go("phrases") }, "To the phrases")
          : null,
        two
          ? h("button", { type: "button", onclick: () => compare(one, other) }, "Compare the two")
          : null,
        two && kind !== "look_alike" ? changeButton(one, other) : null,
        gestures.map((label) => editLink(label)),
      ),
    ),
  );
}

/**
 * Draw the findings of a report; `only` keeps those about the same gestures.
 *
 * @param {Finding[]} findings
 * @param {string[] | null} [only]
 */
export function findingsList(findings, only = null) {
  const shown = only
    ? findings.filter(
        ({ gestures }) =>
          gestures.length === only.length && gestures.every((label) => only.includes(label)),
      )
    : findings;
  if (!shown.length) return null;
  /** @param {Finding} each */
  const draw = (each) => finding(each, only !== null);
  const list = h(
    "ul",
    { className: "findings", "aria-label": "Findings" },
    shown.slice(0, AT_FIRST).map(draw),
  );
  if (shown.length <= AT_FIRST) return list;
  const rest = h("button", { type: "button" }, `Show all ${shown.length} findings`);
  rest.onclick = () => {
    list.append(...shown.slice(AT_FIRST).map(draw));
    /** @type {HTMLElement | null} */ (list.children[AT_FIRST].querySelector("button, a"))?.focus();
    rest.remove();
  };
  return h("div", {}, list, rest);
}
