// Two gestures side by side: their images, their movements on one time cursor, and how they differ.

import * as api from "../core/api.js";
import { h, icon } from "../core/dom.js";
import { bind } from "../core/key-bindings.js";
import { currentLanguage, follow, state, update } from "../core/state.js";
import { attempt } from "../core/toasts.js";
import { editLink, pairOf } from "./finding-links.js";
import { findingsList } from "./findings-list.js";
import { boxOf, movingPaths } from "./movement-paths.js";
import { stepsOf, timeCursor } from "./pair-cursor.js";
import { changeButton } from "./replacements.js";

/** @import { PairDifference } from "../core/types.d.ts" */

const close = () => update({ pair: null });

bind({
  keys: ["Escape"],
  text: "Back to all gestures",
  group: "Two gestures side by side",
  run: close,
  when: () => state.view === "health" && state.pair !== null,
});

/**
 * @param {[string, string]} labels
 * @param {PairDifference} pair
 */
function sentences([one, other], { differs, alignment }) {
  /**
   * @param {string | null} words
   * @param {string} from
   * @param {string} to
   */
  const difference = (words, from, to) =>
    words ? h("li", {}, `${from} differs from ${to} by: ${words}.`) : null;
  return h(
    "ul",
    { className: "pair-words" },
    differs[0] || differs[1]
      ? [difference(differs[0], one, other), difference(differs[1], other, one)]
      : h(
          "li",
          {},
          "The difference is not known: one of them has no demonstration, or follows other keypoints.",
        ),
    alignment?.mirrored ? h("li", {}, `${other} is compared as its mirror image.`) : null,
    alignment?.backward ? h("li", {}, `${other} is compared from its end to its start.`) : null,
  );
}

/**
 * @param {PairDifference["gestures"][number]} gesture
 * @param {string} image
 * @param {SVGElement | undefined} drawing
 */
function figure(gesture, image, drawing) {
  return h(
    "figure",
    { className: "pair-gesture" },
    h("figcaption", {}, h("b", {}, gesture.label), editLink(gesture.label)),
    h(
      "div",
      { className: "pair-drawings" },
      drawing ??
        h(
          "p",
          { className: "dim no-paths" },
          "Without a demonstration there is no movement to show.",
        ),
      h("img", { src: image, alt: `Trajectory image of ${gesture.label}`, width: 96, height: 96 }),
    ),
  );
}

/**
 * @param {PairDifference} found
 * @param {(label: string) => string} imageOf
 */
function sideBySide(found, imageOf) {
  const { gestures } = found;
  const labels = gestures.map(({ label }) => label);
  const box = boxOf(gestures);
  const moving = gestures.map((gesture) =>
    box && gesture.time.length ? movingPaths(gesture, box) : null,
  );
  const cursor = moving.every((each) => each !== null)
    ? timeCursor(stepsOf(found), labels, ({ seconds }) =>
        moving.forEach(({ show }, index) => show(seconds[index])),
      )
    : null;
  return [
    h(
      "div",
      { className: "pair-gestures" },
      gestures.map((gesture, index) =>
        figure(gesture, imageOf(gesture.label), moving[index]?.drawing),
      ),
    ),
    ...(cursor ? [cursor.element] : []),
  ];
}

/** @type {(() => void) | null} */
let fill = null; // Draws the findings; the report may arrive after the gestures.

follow(["health"], () => fill?.());

/**
 * Draw two gestures into a box, as soon as they are loaded.
 *
 * @param {HTMLElement} box
 * @param {(label: string) => string} imageOf
 */
export async function showPair(box, imageOf) {
  const { pair } = state;
  const language = currentLanguage();
  fill = null;
  const labels = pairOf(pair);
  const known = labels !== null && labels.every((label) => language.labels.includes(label));
  const title = h(
    "h1",
    { tabIndex: -1 },
    known ? `${labels[0]} and ${labels[1]}` : "No such two gestures",
  );
  const head = h(
    "div",
    { className: "page-head" },
    h(
      "button",
      { type: "button", className: "back", onclick: close },
      icon("chevron"),
      "All gestures",
    ),
    title,
  );
  box.replaceChildren(head);
  title.focus();
  if (!known)
    return box.append(
      h(
        "p",
        { className: "dim" },
        "The link names gestures that this language does not have, or no longer has.",
      ),
    );
  const found = await attempt("Comparing the gestures", () =>
    api.languages.contrast(language.id, ...labels, language.revision),
  );
  if (!found || state.pair !== pair || !head.isConnected) return undefined;
  const findings = h("div", { className: "pair-findings" });
  box.append(...[sentences(labels, found), ...sideBySide(found, imageOf), findings]);
  head.append(changeButton(...labels));
  fill = () => {
    const report = state.health?.id === language.id ? state.health.report : null;
    findings.replaceChildren(
      ...[findingsList(report?.warnings ?? [], labels)].filter((each) => each !== null),
    );
  };
  return fill();
}
