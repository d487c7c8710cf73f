// The trial of phrases: clicked gestures are parsed as on the robot.

import * as api from "../core/api.js";
import { h, reconcile } from "../core/dom.js";
import { askWhich } from "../core/format.js";
import { follow, state, update } from "../core/state.js";
import { attempt } from "../core/toasts.js";
import { called, ROLES } from "./grammar-edits.js";
import { grammar, saved } from "./grammar-store.js";

/** @import { Gesture, PhraseEvent, PhrasesAnswer } from "../core/types.d.ts" */

/** The events that end a message; the next gesture begins another one. */
const OVER = new Set(["complete", "ambiguous", "cancelled", "timed_out", "unexpected", "outside"]);
/** @type {Record<string, string>} */
const MARKS = { complete: "\u2713", continues: "\u2026", repeat: "?" };

// The server's answer; `settled` says whether it is about the gestures shown now.
/** @type {{ key: string, view: PhrasesAnswer | null, settled: boolean } | null} */
let answer = null;
/** @type {(() => void)[]} */
const listeners = [];

/** The latest answer about the phrases on display, or null. */
export const found = () => answer?.view ?? null;

/**
 * Call `react` after each new answer.
 *
 * @param {() => void} react
 */
export const followFound = (react) => listeners.push(react);

/**
 * The gestures shown, "" for one that was not recognised, two with a tab between them for a pair.
 * The URL has one per line, since a label has neither tabs nor line breaks.
 */
const shown = () => (state.shown === null ? [] : state.shown.split("\n"));

/** @param {string[]} gestures */
export const show = (gestures) =>
  update({ shown: gestures.length ? gestures.join("\n") : null, paused: null });

let loading = Promise.resolve(); // the current request

/**
 * Show a phrase with all its parts, after pending edits are saved.
 *
 * @param {string} name
 */
export async function showExample(name) {
  await saved();
  await loading;
  show(found()?.examples[called(grammar().phrases, name)] ?? []);
}

const last = () => found()?.events.at(-1) ?? null;

const BETWEEN = "\t"; // Between the two labels of a pair.

/** @type {string[] | null} */
let picked = null; // The gestures of a pair that is being chosen, or null.

/** @param {PhraseEvent | null} event */
const isOver = (event) => event !== null && OVER.has(event.kind) && !event.pair;

/** @param {string} gesture */
function add(gesture) {
  const over = state.paused || (answer?.settled && isOver(last()));
  show(over ? [gesture] : [...shown(), gesture]);
}

/**
 * Show a gesture, or choose it for the pair.
 *
 * @param {string} gesture
 */
function press(gesture) {
  if (picked === null || gesture === "") picked = null;
  else if (!picked.includes(gesture)) picked.push(gesture);
  if (picked === null) add(gesture);
  else if (picked.length === 2) {
    const pair = picked.join(BETWEEN);
    picked = null;
    add(pair);
  }
}

/** Request the meaning of the gestures shown, whenever they or the phrases change. */
async function load() {
  const { gestures: language, view, shown: gestures, paused } = state;
  if (view !== "phrases" || !language) return;
  const key = JSON.stringify([language.id, language.revision, gestures, paused]);
  if (answer?.key === key) return;
  answer = { key, view: answer?.view ?? null, settled: false };
  const loaded = await attempt("Trying the phrases", () =>
    api.languages.phrases(language, shown(), paused !== null),
  );
  if (!loaded || answer?.key !== key) return;
  answer = { key, view: loaded, settled: true };
  for (const react of listeners) react();
}

const canSpeak = () => "speechSynthesis" in window;

/** @param {string} text */
function speak(text) {
  speechSynthesis.cancel();
  speechSynthesis.speak(Object.assign(new SpeechSynthesisUtterance(text), { lang: "en" }));
}

/** @param {PhraseEvent | null} event */
function lookOf(event) {
  if (event?.kind === "complete") return "well";
  if (event?.pair) return "asked";
  return isOver(event) ? "unwell" : "";
}

/** @param {PhraseEvent | null} event */
function markOf(event) {
  if (!event) return "\u2026";
  return event.pair ? "?" : (MARKS[event.kind] ?? "!");
}

/** @param {PhraseEvent | null} event */
function drawAnswer(event) {
  const words = event ? event.text : "Show a gesture: click it below.";
  return h(
    "div",
    { className: `said ${lookOf(event)}` },
    h("span", { className: "mark", "aria-hidden": "true" }, markOf(event)),
    h("p", { id: "said" }, words),
    canSpeak() && event
      ? h("button", { type: "button", id: "speak", onclick: () => speak(words) }, "Speak")
      : null,
  );
}

/** @param {PhraseEvent | null} event */
function commands(event) {
  if (!event?.mission) return null;
  return h(
    "div",
    { className: "obeyed" },
    h("h3", {}, "Commands to the robot"),
    h(
      "ol",
      {},
      event.mission.map(({ phrase, command }) =>
        h(
          "li",
          {},
          h("b", {}, phrase),
          command === null
            ? h("span", { className: "dim" }, "no command")
            : h("code", {}, typeof command === "string" ? command : JSON.stringify(command)),
        ),
      ),
    ),
  );
}

/**
 * A gesture to click; an existing button is reused, so that no click on it is lost.
 *
 * @param {Gesture} gesture
 * @param {boolean} next
 * @param {HTMLElement | undefined} item
 */
function gestureButton({ label, thumbnail }, next, item) {
  const drawn =
    item ??
    h(
      "li",
      {},
      h(
        "button",
        { type: "button", className: "try-gesture", onclick: () => press(label) },
        h("img", { alt: "", width: 56, height: 56 }),
        h("span", {}, label),
      ),
    );
  const button = /** @type {HTMLElement} */ (drawn.querySelector("button"));
  const picture = /** @type {HTMLImageElement} */ (drawn.querySelector("img"));
  button.classList.toggle("next", next);
  button.setAttribute("aria-label", `Show ${label}${next ? ", may come next" : ""}`);
  const source = api.beside(thumbnail);
  if (picture.getAttribute("src") !== source) picture.src = source;
  const roles = ROLES.filter((role) => grammar()[role] === label).join(", ");
  button.dataset.role = next ? "next" : roles;
  return drawn;
}

/** @param {string} label */
function chip(label) {
  const [one, other] = label.split(BETWEEN);
  if (other) return h("li", { className: "chip asked" }, askWhich([one, other]));
  return h("li", { className: label ? "chip" : "chip rejected" }, label || "not recognised");
}

function hint() {
  const { timeout } = grammar();
  return found()?.may_end
    ? `The message may be over: after ${timeout} s without a gesture it is obeyed.`
    : "Framed and marked \u201cnext\u201d: what may come next.";
}

/** Build the panel; it follows what is shown. */
export function trialPanel() {
  const sequence = h("ol", { className: "shown", "aria-label": "Gestures shown" });
  const result = h("div", { className: "trial-result", role: "status" });
  const gestures = h("ul", { className: "try-gestures", "aria-label": "Gestures to show" });
  const pause = h(
    "button",
    { type: "button", onclick: () => update({ paused: "yes" }) },
    "Pause too long",
  );
  const between = h("button", { type: "button" });
  const drawBetween = () => {
    between.setAttribute("aria-pressed", String(picked !== null));
    between.textContent = picked?.length ? `${picked[0]} or \u2026?` : "Between two";
  };
  between.onclick = () => {
    picked = picked === null ? [] : null;
    drawBetween();
  };
  gestures.addEventListener("click", drawBetween);
  const clear = h("button", { type: "button", onclick: () => show([]) }, "Clear");
  const note = h("p", { className: "dim" });
  const draw = () => {
    if (state.view !== "phrases" || !state.gestures) return;
    const event = state.shown === null ? null : last();
    const expected = new Set(found()?.expected ?? []);
    sequence.replaceChildren(
      ...shown().map(chip),
      ...(state.paused === null ? [] : [h("li", { className: "chip rejected" }, "pause")]),
    );
    result.replaceChildren(...[drawAnswer(event), commands(event)].filter((each) => each !== null));
    reconcile(
      gestures,
      state.gestures.gestures,
      ({ label }) => label,
      (gesture, item) => gestureButton(gesture, expected.has(gesture.label), item),
    );
    pause.disabled = !event || isOver(event) || state.paused !== null;
    drawBetween();
    clear.disabled = state.shown === null;
    note.textContent = hint();
  };
  followFound(draw);
  follow(["view", "gestures", "shown", "paused"], () => {
    loading = load();
    draw();
  });
  return h(
    "section",
    { className: "panel trial", "aria-labelledby": "trial-title" },
    h("h2", { id: "trial-title" }, "Try it"),
    sequence,
    result,
    gestures,
    h(
      "div",
      { className: "trial-actions" },
      h("button", { type: "button", onclick: () => press("") }, "Not recognised"),
      between,
      pause,
      clear,
    ),
    note,
  );
}
