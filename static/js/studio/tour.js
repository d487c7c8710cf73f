// The tour of a first visit: a card that points at parts of the page, which stays usable.

import { browserStore } from "../core/browser-store.js";
import { byId, h } from "../core/dom.js";
import { follow, selectedClip } from "../core/state.js";
import { go } from "../core/views.js";
import { buttonOf, html, nothing, render } from "../templates.js";
import { showExample } from "./welcome.js";

/** `onClip`: the step needs a clip; without one the example is offered. */
/** @typedef {{ title: string, text: string, places: string[], onClip?: boolean }} Step */

const KEY = "osg-studio.tour"; // The tour starts by itself once.
const GAP = 12; // px between the card and what it points at.

/**
 * Each step points at the first of its places that is visible; without one, the card stands alone.
 */
/** @type {Step[]} */
const STEPS = [
  {
    title: "New here?",
    text: "Four steps lead from a clip to a file for the robot. The page stays usable meanwhile.",
    places: [],
  },
  {
    title: "1. Give it a clip",
    text: "Drop clips anywhere in the window. Sample clips are below the list.",
    places: [".drop label"],
  },
  {
    title: "2. Save the take as a gesture",
    text: "The timeline marks what lies between two salutes. Save it as a gesture, or recognise it.",
    places: ["#clip-bar", "#save-gesture", ".question"],
    onClip: true,
  },
  {
    title: "3. Ask why",
    text: "After an answer you see what differs, where, and which change would help.",
    places: ["#why", "#recognise", ".question"],
    onClip: true,
  },
  {
    title: "4. Export the language",
    text: "Gestures make a language. Export writes it as one file for the robot.",
    places: ["#export"],
  },
];

/** @type {HTMLElement | null} */
let card = null;
/** @type {Element | null} */
let pointed = null; // what the card points at
/** @type {HTMLElement | null} */
let came = null; // where the focus was
let at = 0; // the step on display
let listening = new AbortController();
let offering = false; // whether it offers the example

/** @param {Element} element */
const visible = (element) => element.checkVisibility() && element.getBoundingClientRect().width > 0;

/** @param {Step} step */
const placeOf = (step) =>
  step.places.flatMap((place) => [...document.querySelectorAll(place)]).find(visible) ?? null;

/** @param {Step} step */
const offersExample = ({ onClip }) => Boolean(onClip) && !selectedClip();

/** Place the card beside its target, where the window has room for both. */
function position() {
  if (!card) return;
  const { offsetWidth: width, offsetHeight: height } = card;
  const [mostLeft, mostTop] = [innerWidth - width - GAP, innerHeight - height - GAP];
  /** @type {number[][]} */
  const spots = [];
  if (pointed) {
    const box = pointed.getBoundingClientRect();
    const [left, top] = [Math.min(box.left, mostLeft), Math.min(box.top, mostTop)];
    spots.push([left, box.bottom + GAP], [left, box.top - GAP - height]);
    spots.push([box.right + GAP, top], [box.left - GAP - width, top]);
    const size = `width: ${box.width + 8}px; height: ${box.height + 8}px`;
    byId("tour-ring").style.cssText = `left: ${box.left - 4}px; top: ${box.top - 4}px; ${size}`;
  }
  const [left, top] = spots.find(
    ([x, y]) => x >= 0 && y >= 0 && x <= mostLeft + GAP && y <= mostTop + GAP,
  ) ?? [GAP, mostTop];
  card.style.cssText = `left: ${left}px; top: ${top}px`;
}

/**
 * A press on the page answers the first card: who begins by himself needs no tour.
 *
 * @param {PointerEvent} event
 */
function pressed({ target }) {
  if (at === 0 && !card?.contains(/** @type {Node} */ (target))) end();
}

/** @param {KeyboardEvent} event */
function escape(event) {
  if (event.key === "Escape" && !document.querySelector("dialog[open]")) end();
}

function end() {
  if (!card) return;
  listening.abort();
  byId("tour-ring")?.remove();
  card.remove();
  card = null;
  came?.focus?.();
  browserStore.set(KEY, "seen");
}

/**
 * @param {number} number
 * @param {boolean} focus
 */
function show(number, focus) {
  const step = STEPS[number];
  at = number;
  if (!card) return;
  card.classList.toggle("intro", !number);
  offering = offersExample(step);
  const last = number === STEPS.length - 1;
  pointed = placeOf(step);
  pointed?.scrollIntoView({ block: "center" });
  byId("tour-ring").hidden = !pointed;
  const example = html`<button type="button" @click=${showExample}>Open the example</button>`;
  const back = html`<button type="button" @click=${() => show(number - 1, true)}>Back</button>`;
  const skip = html`<button type="button" class="quiet" @click=${end}>Skip</button>`;
  render(
    html`<h2 id="tour-title">${step.title}</h2>
      <p id="tour-text">${step.text}</p>
      ${offering ? example : nothing}
      <div class="tour-actions">
        <span class="dim">${number + 1} of ${STEPS.length}</span>
        <span class="spacer"></span>
        ${number ? back : nothing}${last ? nothing : skip}
        ${buttonOf(
          last ? "Done" : number ? "Next" : "Show me",
          () => (last ? end() : show(number + 1, true)),
          { look: "primary" },
        )}
      </div>`,
    card,
  );
  position();
  if (focus) /** @type {HTMLElement | null} */ (card.querySelector(".primary"))?.focus();
}

/** Point at elements that appeared since, such as the example. */
function refresh() {
  if (!card) return;
  if (placeOf(STEPS[at]) !== pointed || offersExample(STEPS[at]) !== offering)
    show(at, card.contains(document.activeElement));
  else position();
}

// After everything else is drawn.
follow(["clip", "clips", "takes", "result", "why"], () => requestAnimationFrame(refresh));

/** @param {boolean} focus */
function begin(focus) {
  came = /** @type {HTMLElement | null} */ (document.activeElement);
  card = h("section", {
    className: "tour",
    role: "dialog",
    "aria-labelledby": "tour-title",
    "aria-describedby": "tour-text",
  });
  // Early in the order of Tab, so that a keyboard finds it.
  document.body.prepend(h("div", { id: "tour-ring", className: "tour-ring", hidden: true }), card);
  show(0, focus);
  listening = new AbortController();
  const { signal } = listening;
  addEventListener("resize", position, { signal });
  addEventListener("scroll", position, { signal, capture: true });
  addEventListener("keydown", escape, { signal });
  addEventListener("pointerdown", pressed, { signal });
}

/** Start the tour on request. */
export function startTour() {
  end();
  go("studio");
  begin(true);
}

/** Start the tour on a first visit, without taking the focus. */
export function offerTour() {
  if (browserStore.get(KEY) === null) begin(false);
}
