// The findings in the order of the report, each with links to where it can be mended.

import * as api from "../core/api.js";
import { state, update } from "../core/state.js";
import { attempt } from "../core/toasts.js";
import { edit } from "../languages/revision-edit.js";
import { buttonOf, html, nothing } from "../templates.js";
import { go } from "../core/views.js";
import { compare, editLink } from "./finding-links.js";
import { changeButton } from "./replacements.js";

/** @import { Finding } from "../core/types.d.ts" */

const AT_FIRST = 5; // Findings shown before the table and the map; the worst come first.

/**
 * Set the switch of the hand shape for both gestures, as one edit.
 *
 * @param {string[]} labels
 * @param {"on" | "off"} position
 */
const decideHands = (labels, position) =>
  attempt("Changing the switch", () =>
    edit(
      "Changing the switch",
      `Hand shape of ${labels.join(" and ")} ${position}`,
      async (base) => {
        let language = base;
        for (const label of labels)
          language = await api.languages.changeGesture(language, label, { hand_shape: position });
        return language;
      },
    ),
  );

/**
 * The answers to the question whether the hands of two gestures are meant.
 *
 * @param {string[]} labels
 */
const handAnswers = (labels) =>
  html`${buttonOf("Yes", () => decideHands(labels, "on"), {
    writes: true,
    title: "The hand shape tells them apart",
  })}${buttonOf("No", () => decideHands(labels, "off"), {
    writes: true,
    title: "Any hand may show them",
  })}`;

/**
 * @param {Finding} finding
 * @param {boolean} compared whether its gestures stand side by side already
 */
function finding({ kind, gestures, message, error, drawings }, compared) {
  const [one, other] = gestures;
  const two = gestures.length === 2 && !compared;
  const links = [
    kind === "hand_shape_undecided" ? handAnswers(gestures) : nothing,
    kind.startsWith("phrases_")
      ? html`<button type="button" @click=${() => go("phrases")}>To the phrases</button>`
      : nothing,
    two
      ? html`<button type="button" @click=${() => compare(one, other)}>Compare the two</button>`
      : nothing,
    two && kind !== "look_alike" ? changeButton(one, other) : nothing,
    gestures.map((label) => editLink(label)),
  ];
  return html`<li class="finding ${error ? "error" : "note"}">
    <span class="mark" aria-hidden="true">${error ? "!" : "i"}</span>
    <div class="finding-text">
      <p><b>${error ? "Error: " : "Note: "}</b>${message}</p>
      ${
        drawings.length
          ? html`<div class="finding-drawings">
              ${drawings.map(
                (drawing, index) =>
                  html`<img
                    src=${drawing}
                    alt="Hand of ${gestures[index]}"
                    width="96"
                    height="96"
                  />`,
              )}
            </div>`
          : nothing
      }
      <div class="finding-links">${links}</div>
    </div>
  </li>`;
}

/**
 * Show all findings, and go to the first that was not shown.
 *
 * @param {Event} event
 * @param {Finding[]} unfolded
 */
function showAll({ target }, unfolded) {
  const list = /** @type {HTMLElement} */ (target).previousElementSibling;
  update({ unfolded });
  /** @type {HTMLElement | null} */ (list?.children[AT_FIRST].querySelector("button, a"))?.focus();
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
  if (!shown.length) return nothing;
  const part = state.unfolded === findings ? shown : shown.slice(0, AT_FIRST);
  const list = html`<ul class="findings" aria-label="Findings">
    ${part.map((each) => finding(each, only !== null))}
  </ul>`;
  if (shown.length <= AT_FIRST) return list;
  return html`<div>
    ${list}${
      part.length < shown.length
        ? html`<button
            type="button"
            @click=${(/** @type {Event} */ event) => showAll(event, findings)}
          >
            Show all ${shown.length} findings
          </button>`
        : nothing
    }
  </div>`;
}
