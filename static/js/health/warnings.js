// What was found, the worst first, each with what would help and where to do it.

import { h } from "../dom.js";
import { go } from "../views.js";
import { compare, editLink } from "./links.js";
import { told } from "./report.js";

function remedy({ gesture, text, before, after }) {
  return h("li", { className: "remedy" },
    h("span", { className: "remedy-text" }, text),
    h("span", { className: "effect num", title: `${told(before)} without, ${told(after)} with it` },
      h("span", { className: "visually-hidden" }, "confused in "), h("span", {}, told(before)), h("span", { "aria-label": "then" }, "\u2192"), h("b", {}, told(after))),
    editLink(gesture));
}

function warning({ code, gestures, message, below_bar: below, remedies }) {
  const mended = new Set(remedies.map((each) => each.gesture));
  return h("li", { className: `finding ${below ? "below" : "note"}` },
    h("span", { className: "mark", "aria-hidden": "true" }, below ? "!" : "i"),
    h("div", { className: "finding-text" },
      h("p", {}, h("b", {}, below ? "Below the bar: " : "Note: "), message),
      remedies.length ? h("p", { className: "dim remedies-title" }, "What would help, and how often the two would be confused then") : null,
      remedies.length ? h("ul", { className: "remedy-list", "aria-label": `Remedies for ${gestures.join(" and ")}` }, remedies.map(remedy)) : null,
      h("div", { className: "finding-links" },
        code?.startsWith("phrases_") ? h("button", { type: "button", onclick: () => go("phrases") }, "To the phrases") : null,
        gestures.length === 2 ? h("button", { type: "button", onclick: () => compare(...gestures) }, "Compare the two") : null,
        gestures.filter((label) => !mended.has(label)).map((label) => editLink(label)))));
}

/** Draw the warnings of a report; `only` keeps those about the same gestures. */
export function warningsList(warnings, only = null) {
  const shown = only ? warnings.filter(({ gestures }) => gestures.length === only.length && gestures.every((label) => only.includes(label))) : warnings;
  return shown.length ? h("ul", { className: "findings", "aria-label": "Warnings" }, shown.map(warning)) : null;
}
