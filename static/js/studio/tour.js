// The tour of a first visit: a card that points at parts of the page, which stays usable.

import { byId, h } from "../core/dom.js";
import { follow, selectedClip } from "../core/state.js";
import { go } from "../core/views.js";
import { showExample } from "./welcome.js";

/** `onClip`: the step needs a clip; without one the example is offered. */
/** @typedef {{ title: string, text: string, places: string[], onClip?: boolean }} Step */

const KEY = "osg-studio.tour"; // localStorage: the tour starts by itself once.
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
    text: "Drop clips anywhere in the window: Vulcan salute, the gesture, Vulcan salute. Sample clips are below the list.",
    places: [".drop label", "#clips"],
  },
  {
    title: "2. Save the take as a gesture",
    text: "The take between two salutes appears on the timeline. Save it as a gesture, or recognise it.",
    places: ["#clip-bar", "#stage"],
    onClip: true,
  },
  {
    title: "3. Ask why",
    text: "Every voter has a distance to every gesture: see which voters were wrong, and which change would help.",
    places: ["#why", ".lab"],
    onClip: true,
  },
  {
    title: "4. Keep it in a language",
    text: "Gestures make a language. Every change is kept and can be undone; Export writes the file for the robot.",
    places: ["#views a:nth-child(2)", ".picker"],
  },
];

/** @type {HTMLElement | null} */
let card = null;
/** @type {Element | null} */
let pointed = null; // what the card points at
/** @type {HTMLElement | null} */
let came = null; // where the focus was
let at = 0; // the step on display
let offering = false; // whether it offers the example

const seen = () => {
  try {
    return localStorage.getItem(KEY) !== null;
  } catch {
    return true;
  }
};

function remember() {
  try {
    localStorage.setItem(KEY, "seen");
  } catch {
    /* a browser without storage shows it again */
  }
}

/** @param {Element} element */
const visible = (element) => element.checkVisibility() && element.getBoundingClientRect().width > 0;

/** @param {Step} step */
const placeOf = (step) =>
  step.places.flatMap((place) => [...document.querySelectorAll(place)]).find(visible) ?? null;

/** @param {Step} step */
const offersExample = ({ onClip }) => Boolean(onClip) && !selectedClip();

/** Place the card so that it does not cover its target, as far as the window has room. */
function position() {
  if (!card) return;
  const [ring, place] = [byId("tour-ring"), pointed];
  const { width, height } = card.getBoundingClientRect();
  const { innerWidth: w, innerHeight: t } = window;
  /**
   * @param {number} value
   * @param {number} most
   */
  const clamp = (value, most) => Math.max(GAP, Math.min(value, most - GAP));
  if (!place) {
    Object.assign(card.style, {
      left: `${clamp(w - width - GAP, w - width)}px`,
      top: `${clamp(t - height - GAP, t - height)}px`,
    });
    return;
  }
  const box = place.getBoundingClientRect();
  Object.assign(ring.style, {
    left: `${box.left - 4}px`,
    top: `${box.top - 4}px`,
    width: `${box.width + 8}px`,
    height: `${box.height + 8}px`,
  });
  const beside = box.right + GAP + width <= w;
  const below = box.bottom + GAP + height <= t;
  const above = box.top - GAP - height >= 0;
  const left = beside && !below ? box.right + GAP : box.left;
  const top = below
    ? box.bottom + GAP
    : beside
      ? box.top
      : above
        ? box.top - GAP - height
        : box.bottom - height - GAP;
  Object.assign(card.style, {
    left: `${clamp(left, w - width)}px`,
    top: `${clamp(top, t - height)}px`,
  });
}

/** @param {KeyboardEvent} event */
function escape(event) {
  if (event.key === "Escape" && !document.querySelector("dialog[open]")) end();
}

function end() {
  if (!card) return;
  removeEventListener("resize", position);
  removeEventListener("scroll", position, true);
  removeEventListener("keydown", escape);
  byId("tour-ring")?.remove();
  card.remove();
  card = null;
  came?.focus?.();
  remember();
}

/**
 * @param {number} number
 * @param {boolean} focus
 */
function show(number, focus) {
  const step = STEPS[number];
  at = number;
  offering = offersExample(step);
  const last = number === STEPS.length - 1;
  const place = placeOf(step);
  place?.scrollIntoView({ block: "center" });
  const ring = byId("tour-ring");
  ring.hidden = !place;
  const onward = h(
    "button",
    {
      type: "button",
      className: "primary",
      onclick: () => (last ? end() : show(number + 1, true)),
    },
    last ? "Done" : number ? "Next" : "Show me",
  );
  card?.replaceChildren(
    h("h2", { id: "tour-title" }, step.title),
    h("p", { id: "tour-text" }, step.text),
    offering ? h("button", { type: "button", onclick: showExample }, "Open the example") : "",
    h(
      "div",
      { className: "tour-actions" },
      h("span", { className: "dim" }, `${number + 1} of ${STEPS.length}`),
      h("span", { className: "spacer" }),
      number
        ? h("button", { type: "button", onclick: () => show(number - 1, true) }, "Back")
        : null,
      last ? null : h("button", { type: "button", className: "quiet", onclick: end }, "Skip"),
      onward,
    ),
  );
  pointed = place;
  position();
  if (focus) onward.focus();
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
  addEventListener("resize", position);
  addEventListener("scroll", position, true);
  addEventListener("keydown", escape);
}

/** Start the tour on request. */
export function startTour() {
  end();
  go("studio");
  begin(true);
}

/** Start the tour on a first visit, without taking the focus. */
export function offerTour() {
  if (!seen()) begin(false);
}
