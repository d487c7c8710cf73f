// The trial of phrases: clicked gestures are parsed as on the robot.

import * as api from "../core/api.js";
import { askWhich } from "../core/format.js";
import { follow, state, update } from "../core/state.js";
import { attempt } from "../core/toasts.js";
import { buttonOf, html, nothing, repeat } from "../templates.js";
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
let draw = () => {};

/** The latest answer about the phrases on display, or null. */
export const found = () => answer?.view ?? null;

/** @param {number} count */
export const ambiguities = (count) => `${count} ${count === 1 ? "ambiguity" : "ambiguities"}`;

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
  draw();
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
  draw();
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
  const speaking = () => speak(words);
  return html`<div class="said ${lookOf(event)}">
    <span class="mark" aria-hidden="true">${markOf(event)}</span>
    <p id="said">${words}</p>
    ${
      canSpeak() && event
        ? html`<button type="button" id="speak" @click=${speaking}>Speak</button>`
        : nothing
    }
  </div>`;
}

/** @param {string | object | null} command */
function commandOf(command) {
  if (command === null) return html`<span class="dim">no command</span>`;
  return html`<code>${typeof command === "string" ? command : JSON.stringify(command)}</code>`;
}

/** @param {PhraseEvent | null} event */
function commands(event) {
  if (!event?.mission) return nothing;
  return html`<div class="obeyed">
    <h3>Commands to the robot</h3>
    <ol>
      ${event.mission.map(
        ({ phrase, command }) => html`<li><b>${phrase}</b>${commandOf(command)}</li>`,
      )}
    </ol>
  </div>`;
}

/**
 * A gesture to click.
 *
 * @param {Gesture} gesture
 * @param {boolean} next
 */
function gestureButton({ label, thumbnail }, next) {
  const roles = ROLES.filter((role) => grammar()[role] === label).join(", ");
  return html`<li>
    <button
      type="button"
      class="try-gesture ${next ? "next" : ""}"
      aria-label="Show ${label}${next ? ", may come next" : ""}"
      data-role=${next ? "next" : roles}
      @click=${() => press(label)}
    >
      <img alt="" width="56" height="56" src=${api.beside(thumbnail)} /><span>${label}</span>
    </button>
  </li>`;
}

/** @param {string} label */
function chip(label) {
  const [one, other] = label.split(BETWEEN);
  if (other) return html`<li class="chip asked">${askWhich([one, other])}</li>`;
  return html`<li class="chip ${label ? "" : "rejected"}">${label || "not recognised"}</li>`;
}

function hint() {
  const { timeout } = grammar();
  return found()?.may_end
    ? `The message may be over: after ${timeout} s without a gesture it is obeyed.`
    : "Framed and marked \u201cnext\u201d: what may come next.";
}

/**
 * Request the meaning of what is shown, and call `react` with each new answer.
 *
 * @param {() => void} react
 */
export function followTrial(react) {
  draw = react;
  follow(["view", "gestures", "shown", "paused"], () => {
    loading = load();
  });
}

function pickTwo() {
  picked = picked === null ? [] : null;
  draw();
}

/** Draw the panel. */
export function trialPanel() {
  const event = state.shown === null ? null : last();
  const expected = new Set(found()?.expected ?? []);
  return html`<section class="panel trial" aria-labelledby="trial-title">
    <h2 id="trial-title">Try it</h2>
    <ol class="shown" aria-label="Gestures shown">
      ${shown().map(chip)}${
        state.paused === null ? nothing : html`<li class="chip rejected">pause</li>`
      }
    </ol>
    <div class="trial-result" role="status">${drawAnswer(event)}${commands(event)}</div>
    <ul class="try-gestures" aria-label="Gestures to show">
      ${repeat(
        state.gestures?.gestures ?? [],
        ({ label }) => label,
        (gesture) => gestureButton(gesture, expected.has(gesture.label)),
      )}
    </ul>
    <div class="trial-actions">
      <button type="button" @click=${() => press("")}>Not recognised</button>
      <button type="button" aria-pressed=${picked !== null} @click=${pickTwo}>
        ${picked?.length ? `${picked[0]} or \u2026?` : "Between two"}
      </button>
      ${buttonOf("Pause too long", () => update({ paused: "yes" }), {
        disabled: !event || isOver(event) || state.paused !== null,
      })}
      <button type="button" ?disabled=${state.shown === null} @click=${() => show([])}>
        Clear
      </button>
    </div>
    <p class="dim">${hint()}</p>
  </section>`;
}
