// Trying phrases: gestures are shown by clicking them, and the robot's parser answers.

import * as api from "../api.js";
import { h } from "../dom.js";
import { follow, state, update } from "../state.js";
import { attempt } from "../toasts.js";
import { redraw } from "./fields.js";
import { grammar, labels } from "./grammar.js";

/** After these a message is over, and the next gesture begins another one. */
const OVER = new Set(["complete", "ambiguous", "cancelled", "timed_out", "unexpected", "outside"]);
const MARKS = { complete: "\u2713", continues: "\u2026", repeat: "?" };

let answer = null; // `{ key, view, settled }`: what the server says, and whether of what is shown now
const listeners = [];

/** What is known of the phrases on display, or null. */
export const found = () => answer?.view ?? null;

/** Call `react` whenever something new is known. */
export const followFound = (react) => listeners.push(react);

/** The gestures shown, "" for one that was not recognised. In the URL a line each: no label has two. */
const shown = () => (state.shown === null ? [] : state.shown.split("\n"));

export const show = (gestures) => update({ shown: gestures.length ? gestures.join("\n") : null, paused: null });

/** Show a phrase with all its parts. */
export const showExample = (name) => show(found()?.examples[name] ?? []);

const last = () => found()?.events.at(-1) ?? null;

function add(gesture) {
  const over = state.paused || (answer.settled && OVER.has(last()?.kind));
  show(over ? [gesture] : [...shown(), gesture]);
}

/** Ask what the gestures shown mean, whenever they or the phrases change. */
async function load() {
  const { gestures: language, view, shown: gestures, paused } = state;
  if (view !== "phrases" || !language) return;
  const key = JSON.stringify([language.id, language.revision, gestures, paused]);
  if (answer?.key === key) return;
  answer = { key, view: answer?.view ?? null, settled: false };
  const loaded = await attempt("Trying the phrases", () => api.languages.phrases(language, shown(), paused !== null));
  if (!loaded || answer.key !== key) return;
  answer = { key, view: loaded, settled: true };
  for (const react of listeners) react();
}

const canSpeak = () => "speechSynthesis" in window;

function speak(text) {
  speechSynthesis.cancel();
  speechSynthesis.speak(Object.assign(new SpeechSynthesisUtterance(text), { lang: "en" }));
}

function said(event) {
  const over = event && OVER.has(event.kind);
  const kind = event?.kind ?? "nothing";
  const words = event ? event.text : "Show a gesture: click it below.";
  return h("div", { className: `said ${kind === "complete" ? "well" : over ? "unwell" : ""}` },
    h("span", { className: "mark", "aria-hidden": "true" }, MARKS[kind] ?? (event ? "!" : "\u2026")),
    h("p", { role: "status", id: "said" }, words),
    canSpeak() && event ? h("button", { type: "button", id: "speak", onclick: () => speak(words) }, "Speak") : null);
}

function commands(event) {
  if (!event?.mission) return null;
  return h("div", { className: "obeyed" }, h("h3", {}, "The robot is told"),
    h("ol", {}, event.mission.map(({ phrase, command }) => h("li", {}, h("b", {}, phrase), command === null ? h("span", { className: "dim" }, "no command") : h("code", {}, typeof command === "string" ? command : JSON.stringify(command))))));
}

function gestureButton({ label, thumbnail }, next) {
  const role = ["start", "end", "cancel"].filter((each) => grammar()[each] === label).join(", ");
  return h("li", {}, h("button", { type: "button", className: `try-gesture${next ? " next" : ""}`, id: `try-${label}`, "aria-label": `Show ${label}${next ? ", may come next" : ""}`, onclick: () => add(label) },
    h("img", { src: thumbnail, alt: "", width: 56, height: 56 }), h("span", {}, label), h("small", {}, next ? "next" : role)));
}

function content() {
  const view = found();
  const event = state.shown === null ? null : last();
  const expected = new Set(view?.expected ?? []);
  const sequence = shown();
  const begun = event && !OVER.has(event.kind);
  return [
    h("h2", { id: "trial-title" }, "Try it"),
    h("ol", { className: "shown", "aria-label": "Gestures shown" }, sequence.map((label) => h("li", { className: label ? "chip" : "chip rejected" }, label || "not recognised")), state.paused === null ? null : h("li", { className: "chip rejected" }, "pause")),
    said(event),
    commands(event),
    h("ul", { className: "try-gestures", "aria-label": "Gestures to show" }, state.gestures.gestures.map((gesture) => gestureButton(gesture, expected.has(gesture.label)))),
    h("div", { className: "trial-actions" },
      h("button", { type: "button", id: "try-rejected", onclick: () => add("") }, "Not recognised"),
      h("button", { type: "button", id: "try-pause", onclick: () => update({ paused: "yes" }), disabled: !begun || state.paused !== null }, "Pause too long"),
      h("button", { type: "button", id: "try-clear", onclick: () => show([]), disabled: !sequence.length }, "Clear")),
    h("p", { className: "dim" }, view?.may_end ? `The message may be over: after ${grammar().timeout} s without a gesture it is obeyed.` : `${labels().length ? "Framed and marked \u201cnext\u201d: what may come next." : ""}`),
  ];
}

/** Build the panel; it follows what is shown. */
export function trialPanel() {
  const panel = h("section", { className: "panel trial", "aria-labelledby": "trial-title" });
  const draw = () => { if (state.view === "phrases" && state.gestures?.gestures.length) redraw(panel, ...content()); };
  followFound(draw);
  follow(["view", "gestures", "shown", "paused"], () => { load(); draw(); });
  return panel;
}
