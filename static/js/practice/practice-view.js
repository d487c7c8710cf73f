// The practice view: a diver shows a gesture to the camera or by a clip, reads what to change, and
// gets a record.

import { labelInName } from "../clips/clip-label.js";
import { statusText } from "../clips/clip-store.js";
import { clipsOfDemonstrations } from "../clips/demonstration-ranges.js";
import { olderClipsButton } from "../clips/older-clips.js";
import { takesLanguage } from "../clips/salutes.js";
import * as api from "../core/api.js";
import { tabStore } from "../core/browser-store.js";
import { h, WRITES } from "../core/dom.js";
import { follow, state } from "../core/state.js";
import { limit } from "../core/text-limit.js";
import { attempt, complain } from "../core/toasts.js";
import { buttonOf, elementOf, html, nothing, render } from "../templates.js";
import { addFiles, takeFilesIn } from "../upload/upload-list.js";
import { practiceCamera } from "./practice-camera.js";
import { feedback } from "./practice-feedback.js";
import { recordCard } from "./record-card.js";

/** @import { PracticeRecord, PracticeTake } from "../core/types.d.ts" */

/**
 * A diver's attempt at a gesture of a language.
 *
 * @typedef {{ language: string, diver: string, expected: string }} Attempt
 */

const KEY = "osg-studio.diver"; // One diver practises in a tab.
const LONGEST_NAME = 80;

/** The clips that can be chosen: their poses are found, and they are not demonstrations. */
function shownClips() {
  const demonstrations = new Set(clipsOfDemonstrations(state.gestures));
  return state.clips.filter(({ id, status }) => status === "done" && !demonstrations.has(id));
}

/**
 * The last completed take of a clip, or else the last one begun.
 *
 * @param {string} clip
 */
async function lastTake(clip) {
  const takes = await api.clips.takes(clip, takesLanguage(state.gestures));
  const take = takes.findLast(({ closed }) => closed) ?? takes.at(-1);
  return take ? { start: take.stroke_start, end: take.stroke_end } : null;
}

/**
 * Build the view.
 *
 * @param {HTMLElement} section
 */
export function open(section) {
  const diver = limit(
    h("input", {
      type: "text",
      id: "practice-diver",
      autocomplete: "off",
      value: tabStore.get(KEY) ?? "",
      oninput: () => {
        tabStore.set(KEY, diver.value);
        draw();
      },
    }),
    LONGEST_NAME,
  );
  const gesture = h("select", { id: "practice-gesture" });
  const clip = h("select", { id: "practice-clip" });
  const picture = h("img", { className: "practice-picture", alt: "", width: 160, height: 160 });
  const show = h(
    "button",
    { type: "submit", className: "primary", ...WRITES },
    "Show it by this clip",
  );
  /** @type {"camera" | "clip" | null} as chosen; null: the camera where there is no clip */
  let source = null;
  const by = () => source ?? (clip.options.length ? "clip" : "camera");
  /**
   * @param {"camera" | "clip"} name
   * @param {string} text
   */
  const sourceButton = (name, text) =>
    elementOf(
      buttonOf(text, () => {
        source = name;
        if (name === "clip") camera.stop();
        draw();
      }),
    );
  const [byCamera, byClip] = [sourceButton("camera", "Camera"), sourceButton("clip", "Clip")];
  /** @type {Map<string, Attempt>} */
  const awaited = new Map(); // attempts by their clip, until its poses are found
  /** @returns {Attempt} */
  const attempted = () => ({
    language: state.language ?? "",
    diver: diver.value.trim(),
    expected: gesture.value,
  });
  const camera = practiceCamera({
    started() {
      source = "camera";
    },
    nameOf: () => `${diver.value.trim()} ${gesture.value}`.replace(/[/\\:]/g, " "),
    taken(file) {
      const shown = attempted();
      if (!shown.diver) {
        say("Name the diver: this take is not counted.");
        return;
      }
      say(`Sending the take of ${shown.expected}\u2026`);
      addFiles([file], (id) => {
        awaited.set(id, shown);
        workOff();
      });
    },
  });
  const answer = h("div", { className: "practice-answer", role: "status" });
  const records = h("div", { className: "record-card" });
  const note = h("p", { className: "dim" });
  let offered = "";

  /** @param {PracticeRecord[] | null} all */
  const drawRecords = (all) => {
    const none = html`<p class="dim">Nobody has practised yet.</p>`;
    render(all?.length ? all.map((each) => recordCard(each, remove)) : none, records);
  };

  async function load() {
    const { language } = state;
    if (!language || state.view !== "practice") return;
    const all = await attempt("Loading the records", () => api.practice.records(language));
    if (all && language === state.language) drawRecords(all);
  }

  /** @param {PracticeTake} take */
  async function remove(take) {
    drawRecords(
      await attempt("Removing the take", () => api.practice.remove(state.language ?? "", take.id)),
    );
  }

  function drawPicture() {
    const chosen = state.gestures?.gestures.find(({ label }) => label === gesture.value);
    picture.hidden = !chosen;
    if (!chosen || !state.gestures) return;
    const { id, revision } = state.gestures;
    picture.src = api.languages.image(id, chosen.label, revision);
    picture.alt = `Trajectory of ${chosen.label}, from the dot along the arrow`;
  }

  /** Offer the gestures and clips; the choice among them stays. */
  function offer() {
    const labels = state.gestures?.labels ?? [];
    const clips = shownClips();
    const now = JSON.stringify([labels, clips.map(({ id, name }) => [id, name])]);
    if (now !== offered) {
      offered = now;
      const before = [gesture.value, clip.value];
      gesture.replaceChildren(...labels.map((label) => h("option", { value: label }, label)));
      clip.replaceChildren(...clips.map(({ id, name }) => h("option", { value: id }, name)));
      if (labels.includes(before[0])) gesture.value = before[0];
      if (clips.some(({ id }) => id === before[1])) clip.value = before[1];
      else if (by() === "clip") followName();
    }
    drawPicture();
  }

  /** The gesture that the chosen clip's name suggests. */
  function followName() {
    const name = state.clips.find(({ id }) => id === clip.value)?.name ?? "";
    const suggested = labelInName(name, state.gestures?.labels ?? []);
    if (suggested) gesture.value = suggested;
    drawPicture();
  }

  function draw() {
    offer();
    const byCameraNow = by() === "camera";
    const missing = !gesture.value
      ? "The language has no gestures yet."
      : !byCameraNow && !clip.value
        ? "Drop a clip, or use the camera: the demonstrations themselves do not count."
        : diver.value.trim()
          ? ""
          : "Name the diver.";
    note.textContent = missing;
    note.hidden = !missing;
    show.disabled = Boolean(missing);
    byCamera.setAttribute("aria-pressed", String(byCameraNow));
    byClip.setAttribute("aria-pressed", String(!byCameraNow));
    camera.element.hidden = !byCameraNow;
    clipField.hidden = show.hidden = byCameraNow;
    camera.allow(!missing);
    camera.draw();
  }

  /** @param {string} text */
  const say = (text) => render(html`<p class="dim">${text}</p>`, answer);

  /**
   * Recognise an attempt, and show the feedback.
   *
   * @param {Attempt} shown
   * @param {string} id of the clip
   * @param {{ start: number, end: number } | null} range
   */
  async function recognise({ language, diver: name, expected }, id, range) {
    say("Recognising\u2026");
    try {
      const found = await api.practice.show(language, {
        diver: name,
        expected,
        clip_id: id,
        ...range,
      });
      render(feedback(found), answer);
      answer.scrollIntoView({ block: "nearest" });
      await load();
    } catch (error) {
      render(nothing, answer);
      complain(error, "Recognition");
    }
  }

  /**
   * Recognise the take of a clip of the camera.
   *
   * @param {string} id
   * @param {Attempt} shown
   */
  async function recogniseCamera(id, shown) {
    const take = await attempt("Finding the take", () => lastTake(id));
    if (take) await recognise(shown, id, take);
    else
      say(
        `No take of ${shown.expected} was seen. Step back until hands and hips are in the picture, and show it again.`,
      );
  }

  /** Recognise the camera's clips whose poses are found, and show the progress of the others. */
  function workOff() {
    for (const [id, shown] of awaited) {
      const found = state.clips.find((each) => each.id === id);
      if (!found) continue;
      if (found.status === "done") {
        awaited.delete(id);
        recogniseCamera(id, shown);
      } else if (found.status === "failed" || found.status === "cancelled") {
        awaited.delete(id);
        say(`The take of ${shown.expected} cannot be judged: ${statusText(found)}`);
      } else {
        const text = statusText(found, state.jobs.get(found.job_id));
        say(`Take of ${shown.expected}: ${text}`);
      }
    }
  }

  gesture.onchange = drawPicture;
  clip.onchange = followName;
  /**
   * @param {string} label
   * @param {HTMLElement} input
   */
  const field = (label, input) =>
    elementOf(html`<div class="field"><label for=${input.id}>${label}</label>${input}</div>`);
  const clipField = field("Clip", clip);
  clipField.append(olderClipsButton());
  const form = elementOf(
    html`<form class="practice-form">
      ${picture}
      <div class="practice-fields">
        ${field("Diver", diver)}${field("Gesture to show", gesture)}
        <div class="segments" role="group" aria-label="Shown by">${byCamera}${byClip}</div>
        ${clipField}
        <div class="practice-actions">${show}</div>
        ${note}
      </div>
      ${camera.element}
    </form>`,
  );
  form.onsubmit = async (event) => {
    event.preventDefault();
    if (by() === "camera") return; // Enter in a field.
    show.disabled = true;
    await recognise(attempted(), clip.value, null);
    draw();
  };
  render(
    html`<div class="practice-page">
      <h1>Practice</h1>
      <p class="dim">
        Show a gesture, and read what to change. The record says when a diver’s error rate is proved
        to be low enough for a dive.
      </p>
      ${form}${answer}
      <h2>Records</h2>
      ${records}
    </div>`,
    section,
  );
  takeFilesIn("practice", (files) => addFiles(files));
  follow(["gestures", "clips"], draw);
  follow(["clips", "jobs"], workOff);
  follow(["view", "gestures"], load);
  follow(["language"], camera.listen);
  follow(["view"], ({ view }) => {
    if (view !== "practice") camera.stop();
  });
}
