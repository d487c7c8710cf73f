// The practice view: a diver shows a gesture to the camera or by a clip, reads what to change, and
// gets a record.

import { labelInName } from "../clips/clip-label.js";
import { statusText } from "../clips/clip-store.js";
import { clipsOfDemonstrations } from "../clips/demonstration-ranges.js";
import { olderClipsButton } from "../clips/older-clips.js";
import { takesLanguage } from "../clips/salutes.js";
import * as api from "../core/api.js";
import { tabStore } from "../core/browser-store.js";
import { askWhich } from "../core/format.js";
import { follow, state } from "../core/state.js";
import { MAX_DIVER_LENGTH } from "../core/text-limit.js";
import { attempt, complain } from "../core/toasts.js";
import {
  asOptions,
  buttonOf,
  guard,
  html,
  limited,
  live,
  nothing,
  optionsOf,
  render,
} from "../templates.js";
import { addFiles, takeFilesIn } from "../upload/upload-list.js";
import { practiceCamera } from "./practice-camera.js";
import { recordCard } from "./record-card.js";

/** @import { PracticeAnswer, PracticeRecord, PracticeTake } from "../core/types.d.ts" */

/**
 * A diver's attempt at a gesture of a language.
 *
 * @typedef {{ language: string, diver: string, expected: string }} Attempt
 */

const KEY = "osg-studio.diver"; // One diver practises in a tab.

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
 * The feedback: whether the take was right, and what to change.
 *
 * @param {PracticeAnswer} answer
 */
function feedback({ take, sentence, notes }) {
  const look = take.right ? "right" : take.pair ? "asked" : "wrong";
  const heads = {
    right: "\u2713 Right: ",
    asked: take.pair ? `? ${askWhich(take.pair)} ` : "",
    wrong: "\u2260 Not yet: ",
  };
  return html`<p class="practice-${look}">
      <b>${heads[look]}</b>${take.right ? take.expected : sentence}
    </p>
    ${notes.map((text) => html`<p class="dim">${text}</p>`)}`;
}

/**
 * Build the view.
 *
 * @param {HTMLElement} section
 */
export function open(section) {
  /** What is drawn, with the camera and the state of the page. */
  const now = {
    diver: tabStore.get(KEY) ?? "",
    expected: "",
    clip: "",
    source: /** @type {"camera" | "clip" | null} */ (null), // null: the camera without a clip
    answer: /** @type {unknown} */ (nothing),
    busy: false,
    records: /** @type {PracticeRecord[] | null} */ (null),
  };
  /** @type {Map<string, Attempt>} */
  const awaited = new Map(); // attempts by their clip, until its poses are found
  const olderClips = olderClipsButton();

  /** @param {Partial<typeof now>} change */
  function put(change) {
    Object.assign(now, change);
    draw();
  }

  const by = () => now.source ?? (now.clip ? "clip" : "camera");
  /** @returns {Attempt} */
  const attempted = () => ({
    language: state.language ?? "",
    diver: now.diver.trim(),
    expected: now.expected,
  });
  const camera = practiceCamera({
    draw: () => draw(),
    started: () => put({ source: "camera" }),
    nameOf: () => `${now.diver.trim()} ${now.expected}`.replace(/[/\\:]/g, " "),
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

  async function load() {
    const { language } = state;
    if (!language || state.view !== "practice") return;
    const records = await attempt("Loading the records", () => api.practice.records(language));
    if (records && language === state.language) put({ records });
  }

  /** @param {PracticeTake} take */
  const remove = async (take) =>
    put({
      records: await attempt("Removing the take", () =>
        api.practice.remove(state.language ?? "", take.id),
      ),
    });

  /** @param {string} text */
  const say = (text) => put({ answer: html`<p class="dim">${text}</p>` });

  /**
   * Recognise an attempt, and show the feedback.
   *
   * @param {Attempt} shown
   * @param {string} id of the clip
   * @param {{ start: number, end: number } | null} range
   */
  async function recognise({ language, diver, expected }, id, range) {
    say("Recognising\u2026");
    try {
      const found = await api.practice.show(language, { diver, expected, clip_id: id, ...range });
      put({ answer: feedback(found) });
      section.querySelector(".practice-answer")?.scrollIntoView({ block: "nearest" });
      await load();
    } catch (error) {
      put({ answer: nothing });
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

  /**
   * Choose a clip, and the gesture that its name suggests.
   *
   * @param {string} clip
   */
  function chooseClip(clip) {
    now.clip = clip;
    const name = state.clips.find(({ id }) => id === clip)?.name ?? "";
    const suggested = labelInName(name, state.gestures?.labels ?? []);
    if (suggested && by() === "clip") now.expected = suggested;
  }

  /** @param {SubmitEvent} event */
  async function submit(event) {
    event.preventDefault();
    if (by() === "camera") return; // Enter in a field.
    put({ busy: true });
    await recognise(attempted(), now.clip, null);
    put({ busy: false });
  }

  function picture() {
    const { gestures } = state;
    if (!gestures?.labels.includes(now.expected)) return nothing;
    return html`<img
      class="practice-picture"
      alt="Trajectory of ${now.expected}, from the dot along the arrow"
      width="160"
      height="160"
      src=${api.languages.image(gestures.id, now.expected, gestures.revision)}
    />`;
  }

  /**
   * @param {string} id
   * @param {string} label
   * @param {unknown} input
   */
  const field = (id, label, input) =>
    html`<div class="field"><label for=${id}>${label}</label>${input}</div>`;

  /**
   * @param {"camera" | "clip"} name
   * @param {string} text
   */
  const sourceButton = (name, text) => {
    const choose = () => {
      if (name === "clip") camera.stop();
      put({ source: name });
    };
    return buttonOf(text, choose, { pressed: by() === name });
  };

  /** What is missing for an attempt; empty: nothing. */
  function missing() {
    if (!now.expected) return "The language has no gestures yet.";
    if (by() === "clip" && !now.clip)
      return "Drop a clip, or use the camera: the demonstrations themselves do not count.";
    return now.diver.trim() ? "" : "Name the diver.";
  }

  function draw() {
    const labels = state.gestures?.labels ?? [];
    const clips = shownClips();
    if (!labels.includes(now.expected)) now.expected = labels[0] ?? "";
    if (!clips.some(({ id }) => id === now.clip)) chooseClip(clips[0]?.id ?? "");
    const none = html`<p class="dim">Nobody has practised yet.</p>`;
    const note = missing();
    render(
      html`<div class="practice-page">
        <h1>Practice</h1>
        <p class="dim">
          Show a gesture, and read what to change. The record says when a diver’s error rate is
          proved to be low enough for a dive.
        </p>
        <form class="practice-form" @submit=${submit}>
          ${picture()}
          <div class="practice-fields">
            ${field(
              "practice-diver",
              "Diver",
              html`<input
                type="text"
                id="practice-diver"
                autocomplete="off"
                .value=${live(now.diver)}
                ${limited(MAX_DIVER_LENGTH)}
                @input=${(/** @type {any} */ { target }) => {
                  tabStore.set(KEY, target.value);
                  put({ diver: target.value });
                }}
              />`,
            )}${field(
              "practice-gesture",
              "Gesture to show",
              html`<select
                id="practice-gesture"
                @change=${(/** @type {any} */ { target }) => put({ expected: target.value })}
              >
                ${optionsOf(asOptions(labels), now.expected)}
              </select>`,
            )}
            <div class="segments" role="group" aria-label="Shown by">
              ${sourceButton("camera", "Camera")}${sourceButton("clip", "Clip")}
            </div>
            <div class="field" ?hidden=${by() === "camera"}>
              <label for="practice-clip">Clip</label
              ><select
                id="practice-clip"
                @change=${(/** @type {any} */ { target }) => {
                  chooseClip(target.value);
                  draw();
                }}
              >
                ${guard([state.clips, state.gestures, now.clip], () =>
                  optionsOf(
                    clips.map(({ id, name }) => [id, name]),
                    now.clip,
                  ),
                )}</select
              >${olderClips}
            </div>
            <div class="practice-actions">
              <button
                type="submit"
                class="primary"
                data-writes
                ?hidden=${by() === "camera"}
                ?disabled=${now.busy || Boolean(note)}
              >
                Show it by this clip
              </button>
            </div>
            <p class="dim" ?hidden=${!note}>${note}</p>
          </div>
          ${camera.panel({ hidden: by() === "clip", possible: !note })}
        </form>
        <div class="practice-answer" role="status">${now.answer}</div>
        <h2>Records</h2>
        <div class="record-card">
          ${guard([now.records, state.clips], () =>
            now.records?.length ? now.records.map((each) => recordCard(each, remove)) : none,
          )}
        </div>
      </div>`,
      section,
    );
  }

  takeFilesIn("practice", (files) => addFiles(files));
  follow(["gestures", "clips"], draw);
  follow(["clips", "jobs"], workOff);
  follow(["view", "gestures"], load);
  follow(["language"], camera.listen);
  follow(["view"], ({ view }) => {
    if (view !== "practice") camera.stop();
  });
}
