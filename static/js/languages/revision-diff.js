// Two revisions of a language side by side, gesture by gesture.

import { beside } from "../core/server.js";
import { h } from "../core/dom.js";
import { plural } from "../core/format.js";

/** @import { Gesture, GestureDiff, Revision, RevisionDiff } from "../core/types.d.ts" */

const SIGNS = { added: "+", removed: "\u2212", changed: "\u2260", same: "=" };

/**
 * @param {Gesture | null} gesture
 * @param {string} absent
 */
function picture(gesture, absent) {
  return gesture
    ? h(
        "figure",
        {},
        h("img", {
          src: beside(gesture.thumbnail),
          alt: `Trajectory of ${gesture.label}`,
          loading: "lazy",
          width: 112,
          height: 112,
        }),
        h("figcaption", {}, gesture.label),
      )
    : h("figure", { className: "absent" }, h("span", {}, absent), h("figcaption", {}, "\u00a0"));
}

/** @param {GestureDiff} gesture */
function row({ kind, before, after, words }) {
  return h(
    "li",
    { className: `compared ${kind}` },
    picture(before, "not there"),
    picture(after, "not there"),
    h(
      "div",
      { className: "compared-text" },
      h("span", { className: "kind" }, h("span", { "aria-hidden": "true" }, SIGNS[kind]), kind),
      h("b", {}, (after ?? before)?.label),
      words.length
        ? h(
            "ul",
            {},
            words.map((word) => h("li", {}, word)),
          )
        : null,
    ),
  );
}

/** @param {Revision | null} revision */
const heading = (revision) => (revision ? `Revision ${revision.revision}` : "Nothing");

/**
 * Draw the answer of `GET /languages/{id}/comparison`.
 *
 * @param {HTMLElement} box
 * @param {RevisionDiff} diff
 */
export function drawComparison(box, { older, newer, words, gestures }) {
  const changed = gestures.filter((each) => each.kind !== "same");
  const same = gestures.filter((each) => each.kind === "same");
  /** @param {string} kind */
  const count = (kind) => gestures.filter((each) => each.kind === kind).length;
  const counts = ["added", "removed", "changed"]
    .map((kind) => (count(kind) ? `${count(kind)} ${kind}` : null))
    .filter(Boolean)
    .join(", ");
  box.replaceChildren(
    h(
      "p",
      { className: "diff-summary" },
      counts ? `Gestures: ${counts}.` : "The gestures are the same.",
    ),
    words.length
      ? h(
          "ul",
          { className: "comparison-words" },
          words.map((word) => h("li", {}, word)),
        )
      : "",
    changed.length
      ? h(
          "div",
          { className: "comparison-heads", "aria-hidden": "true" },
          h("span", {}, heading(older)),
          h("span", {}, heading(newer)),
        )
      : "",
    changed.length
      ? h("ul", { className: "compared-list", "aria-label": "What changed" }, changed.map(row))
      : "",
    same.length
      ? h(
          "details",
          { className: "unchanged" },
          h("summary", {}, `${plural(same.length, "gesture")} unchanged`),
          h("ul", { className: "compared-list" }, same.map(row)),
        )
      : "",
  );
}
