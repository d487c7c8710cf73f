// Two gestures side by side: their images, their movements on one time cursor, and how they differ.

import * as api from "../core/api.js";
import { bind } from "../core/key-bindings.js";
import { currentLanguage, follow, state, update } from "../core/state.js";
import { html, iconOf, nothing, render } from "../templates.js";
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
  const words = [
    differs[0] && `${one} differs from ${other} by: ${differs[0]}.`,
    differs[1] && `${other} differs from ${one} by: ${differs[1]}.`,
    differs[0] || differs[1]
      ? null
      : "The difference is not known: one of them has no demonstration, or follows other keypoints.",
    alignment?.mirrored && `${other} is compared as its mirror image.`,
    alignment?.backward && `${other} is compared from its end to its start.`,
  ];
  return html`<ul class="pair-words">
    ${words.filter(Boolean).map((each) => html`<li>${each}</li>`)}
  </ul>`;
}

/**
 * @param {PairDifference["gestures"][number]} gesture
 * @param {string} image
 * @param {SVGElement | undefined} drawing
 */
const figure = ({ label }, image, drawing) =>
  html`<figure class="pair-gesture">
    <figcaption><b>${label}</b>${editLink(label)}</figcaption>
    <div class="pair-drawings">
      ${
        drawing ??
        html`<p class="dim no-paths">Without a demonstration there is no movement to show.</p>`
      }<img src=${image} alt="Trajectory image of ${label}" width="96" height="96" />
    </div>
  </figure>`;

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
  return html`<div class="pair-gestures">
      ${gestures.map((gesture, index) =>
        figure(gesture, imageOf(gesture.label), moving[index]?.drawing),
      )}
    </div>
    ${cursor?.element}`;
}

/** @type {(() => unknown) | null} */
let draw = null; // Draws the page anew; the report may arrive after the gestures.
let calls = 0; // of `showPair`; only the last one draws.

follow(["health", "unfolded"], () => draw?.());

/**
 * Draw two gestures into a box, as soon as they are loaded.
 *
 * @param {HTMLElement} box
 * @param {(label: string) => string} imageOf
 */
export async function showPair(box, imageOf) {
  const { pair } = state;
  const language = currentLanguage();
  const call = (calls += 1);
  draw = null;
  const labels = pairOf(pair);
  const known = labels !== null && labels.every((label) => language.labels.includes(label));
  /**
   * @param {unknown} change the button that proposes other movements
   * @param {unknown} content
   */
  const page = (change, content) =>
    render(
      html`<div class="page-head">
          <button type="button" class="back" @click=${close}>
            ${iconOf("chevron")}All gestures
          </button>
          <h1 tabindex="-1">${known ? `${labels[0]} and ${labels[1]}` : "No such two gestures"}</h1>
          ${change}
        </div>
        ${content}`,
      box,
    );
  page(
    nothing,
    known
      ? nothing
      : html`<p class="dim">
          The link names gestures that this language does not have, or no longer has.
        </p>`,
  );
  box.querySelector("h1")?.focus();
  if (!known) return undefined;
  const [one, other] = labels;
  const found = await attempt("Comparing the gestures", () =>
    api.languages.contrast(language.id, { one, other, revision: language.revision }),
  );
  if (!found || state.pair !== pair || call !== calls) return undefined;
  const words = sentences(labels, found);
  const two = sideBySide(found, imageOf);
  draw = () => {
    const report = state.health?.id === language.id ? state.health.report : null;
    page(
      changeButton(...labels),
      html`${words}${two}
        <div class="pair-findings">${findingsList(report?.warnings ?? [], labels)}</div>`,
    );
  };
  return draw();
}
