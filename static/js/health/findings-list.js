// The findings, the worst first, each with its remedies and links to where to apply them.

import * as api from "../core/api.js";
import { h, WRITES } from "../core/dom.js";
import { complain } from "../core/toasts.js";
import { showDone } from "../core/undo.js";
import { go } from "../core/views.js";
import { edit } from "../languages/revision-edit.js";
import { compare, editLink } from "./finding-links.js";
import { rateText } from "./rates.js";

/** @import { Finding, Language, Remedy } from "../core/types.d.ts" */

const AT_FIRST = 5; // Findings shown before the matrix and the map; the worst come first.
const SWITCHES = new Set(["direction", "tempo", "hand_shape"]); // Remedies that need no new demonstration.

/**
 * Let a switch of some gestures count; one undo takes it back.
 *
 * @param {string} kind
 * @param {string[]} gestures
 * @param {string} text
 * @param {HTMLButtonElement} button
 */
async function switchOn(kind, gestures, text, button) {
  /** @param {Language} base */
  const change = async (base) => {
    let language = base;
    for (const label of gestures)
      language = await api.languages.changeGesture(language, label, { [kind]: "on" });
    return language;
  };
  button.disabled = true;
  try {
    await edit("Applying the remedy", `Remedy: ${text}`, change);
    showDone("Remedy applied", text);
  } catch (error) {
    complain(error, "Applying the remedy");
    button.disabled = false;
  }
}

/**
 * @param {string} kind
 * @param {string[]} gestures
 * @param {string} text
 */
function apply(kind, gestures, text) {
  const button = h(
    "button",
    { type: "button", "aria-label": `Apply: ${text}`, ...WRITES },
    "Apply",
  );
  button.onclick = () => switchOn(kind, gestures, text, button);
  return button;
}

/**
 * @param {Remedy} remedy
 * @param {string[]} gestures
 */
function remedy({ kind, gesture, text, before, after }, gestures) {
  return h(
    "li",
    { className: "remedy" },
    h("span", { className: "remedy-text" }, text),
    h(
      "span",
      { className: "effect num", title: `${rateText(before)} without, ${rateText(after)} with it` },
      h("span", { className: "visually-hidden" }, "confused in "),
      h("span", {}, rateText(before)),
      h("span", { "aria-label": "then" }, "\u2192"),
      h("b", {}, rateText(after)),
    ),
    SWITCHES.has(kind) ? apply(kind, gestures, text) : editLink(gesture),
  );
}

/** @param {Finding} finding */
function finding({ code, gestures, message, below_bar: below, remedies }) {
  const mended = new Set(
    remedies.filter(({ kind }) => !SWITCHES.has(kind)).map((each) => each.gesture),
  );
  return h(
    "li",
    { className: `finding ${below ? "below" : "note"}` },
    h("span", { className: "mark", "aria-hidden": "true" }, below ? "!" : "i"),
    h(
      "div",
      { className: "finding-text" },
      h("p", {}, h("b", {}, below ? "Error: " : "Note: "), message),
      remedies.length
        ? h(
            "p",
            { className: "dim remedies-title" },
            "What would help, and how often the two would then be confused",
          )
        : null,
      remedies.length
        ? h(
            "ul",
            { className: "remedy-list", "aria-label": `Remedies for ${gestures.join(" and ")}` },
            remedies.map((each) => remedy(each, gestures)),
          )
        : null,
      h(
        "div",
        { className: "finding-links" },
        code?.startsWith("phrases_")
          ? h("button", { type: "button", onclick: () => go("phrases") }, "To the phrases")
          : null,
        gestures.length === 2
          ? h(
              "button",
              { type: "button", onclick: () => compare(gestures[0], gestures[1]) },
              "Compare the two",
            )
          : null,
        gestures.filter((label) => !mended.has(label)).map((label) => editLink(label)),
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
  const list = h(
    "ul",
    { className: "findings", "aria-label": "Findings" },
    shown.slice(0, AT_FIRST).map(finding),
  );
  if (shown.length <= AT_FIRST) return list;
  const rest = h("button", { type: "button" }, `Show all ${shown.length} findings`);
  rest.onclick = () => {
    list.append(...shown.slice(AT_FIRST).map(finding));
    /** @type {HTMLElement | null} */ (list.children[AT_FIRST].querySelector("button, a"))?.focus();
    rest.remove();
  };
  return h("div", {}, list, rest);
}
