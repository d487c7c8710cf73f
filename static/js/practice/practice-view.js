// Practice: a diver shows a gesture by a clip, learns what to change, and has a record of it.

import { labelInName } from "../clips/clip-label.js";
import * as api from "../core/api.js";
import { h, iconButton, WRITES } from "../core/dom.js";
import { moment, percent, plural } from "../core/format.js";
import { follow, state } from "../core/state.js";
import { limit } from "../core/text-limit.js";
import { attempt, complain } from "../core/toasts.js";
import { address, go, here } from "../core/views.js";
import { addFiles, takeFilesIn } from "../upload/upload-list.js";

/** @import { PracticeAnswer, PracticeRecord, PracticeTake } from "../core/types.d.ts" */

/** @typedef {(take: PracticeTake) => void} Remove */

const KEY = "osg-studio.diver"; // sessionStorage: one diver practises in a tab.
const LONGEST_NAME = 80;

/** The clips that can be shown: their poses are found, and they are no demonstrations. */
function shownClips() {
  const demonstrations = new Set(
    (state.gestures?.gestures ?? []).flatMap(({ demonstrations: all }) =>
      all.map(({ source }) => source?.clip_id),
    ),
  );
  return state.clips.filter(({ id, status }) => status === "done" && !demonstrations.has(id));
}

/**
 * What the evidence says, and what is missing, in words.
 *
 * @param {Omit<PracticeRecord, "diver" | "older" | "shown">} record
 */
export function evidenceOf({ takes, errors, bound, limit: most, reached, more, confidence }) {
  const counted = `${plural(errors, "error")} in ${plural(takes, "take")}`;
  const sure = `${percent(confidence)} confidence`;
  return reached
    ? `${counted}: under ${percent(most)} errors, by ${sure} at most ${(100 * bound).toFixed(1)} %.`
    : `${counted}: ${plural(more, "more take")} without an error for under ${percent(most)} errors at ${sure}.`;
}

/** @param {PracticeTake} take */
const placeOf = ({ clip_id: clip, recognition_id: recognition }) => ({
  clip,
  recognition,
  take: null,
  start: null,
  end: null,
  frame: null,
});

/**
 * @param {PracticeTake} take
 * @param {Remove} remove
 */
function takeRow(take, remove) {
  const clip = state.clips.find(({ id }) => id === take.clip_id);
  const place = placeOf(take);
  return h(
    "li",
    { className: take.right ? "right" : "wrong" },
    h("span", { "aria-hidden": "true" }, take.right ? "\u2713" : "\u2260"),
    h(
      "span",
      {},
      h("b", {}, take.expected),
      take.right ? " recognised" : ` read as ${take.label ?? "nothing"}`,
      h("small", { className: "dim" }, ` revision ${take.revision}`),
    ),
    clip
      ? h(
          "a",
          { href: address("studio", place), onclick: here(() => go("studio", place)) },
          clip.name,
        )
      : h("span", { className: "dim" }, "its clip was deleted"),
    iconButton("close", `Remove this take of ${take.expected}`, () => remove(take), WRITES),
  );
}

/**
 * @param {PracticeRecord} record
 * @param {Remove} remove
 */
function recordCard(record, remove) {
  const needed = record.takes + record.more;
  return h(
    "section",
    { className: `practice-record${record.reached ? " reached" : ""}`, "aria-label": record.diver },
    h("h3", {}, record.diver, record.reached ? " \u2713" : ""),
    h("p", {}, evidenceOf(record)),
    h("progress", {
      "aria-label": `Takes of ${record.diver}`,
      max: Math.max(1, needed),
      value: record.takes,
    }),
    record.older
      ? h(
          "p",
          { className: "dim" },
          `${plural(record.older, "take")} with older revisions of the language do not count.`,
        )
      : null,
    h(
      "details",
      {},
      h("summary", {}, plural(record.shown.length, "take")),
      h(
        "ul",
        { className: "practice-takes" },
        record.shown.map((take) => takeRow(take, remove)),
      ),
    ),
  );
}

/**
 * What to tell the diver about the take that was just shown.
 *
 * @param {PracticeAnswer} answer
 */
function feedback({ take, sentence, lesson, notes }) {
  return [
    h(
      "p",
      { className: take.right ? "practice-right" : "practice-wrong" },
      h("b", {}, take.right ? "\u2713 Right: " : "\u2260 Not yet: "),
      take.right ? take.expected : sentence,
    ),
    lesson
      ? h(
          "p",
          { className: "lesson" },
          h("b", {}, "Show it again: "),
          `in this take ${lesson.words}${lesson.start === null ? "" : ` (from ${moment(lesson.start)})`}.`,
        )
      : null,
    ...notes.map((text) => h("p", { className: "dim" }, text)),
  ].filter((each) => each !== null);
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
      value: sessionStorage.getItem(KEY) ?? "",
      oninput: () => {
        sessionStorage.setItem(KEY, diver.value);
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
  const answer = h("div", { className: "practice-answer", role: "status" });
  const records = h("div", { className: "practice-records" });
  const note = h("p", { className: "dim" });
  let offered = "";

  /** @param {PracticeRecord[] | null} all */
  const drawRecords = (all) =>
    records.replaceChildren(
      ...(all ?? []).map((each) => recordCard(each, remove)),
      ...(all?.length ? [] : [h("p", { className: "dim" }, "Nobody has practised yet.")]),
    );

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

  /** Offer the gestures and clips there are; what is chosen among them stays. */
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
      else followName();
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
    const missing = !gesture.value
      ? "The language has no gestures yet."
      : !clip.value
        ? "Record a clip, or drop one: the demonstrations themselves do not count."
        : diver.value.trim()
          ? ""
          : "Name the diver.";
    note.textContent = missing;
    show.disabled = Boolean(missing);
  }

  gesture.onchange = drawPicture;
  clip.onchange = followName;
  /**
   * @param {string} label
   * @param {HTMLElement} input
   */
  const field = (label, input) =>
    h("div", { className: "field" }, h("label", { for: input.id }, label), input);
  const form = h(
    "form",
    { className: "practice-form" },
    picture,
    h(
      "div",
      { className: "practice-fields" },
      field("Diver", diver),
      field("Gesture to show", gesture),
      field("Clip", clip),
      h(
        "div",
        { className: "practice-actions" },
        show,
        h(
          "button",
          { type: "button", onclick: () => go("live", { source: null }) },
          "Record with the camera",
        ),
      ),
      note,
    ),
  );
  form.onsubmit = async (event) => {
    event.preventDefault();
    show.disabled = true;
    answer.replaceChildren(h("p", { className: "dim" }, "Recognising\u2026"));
    try {
      const found = await api.practice.show(state.language ?? "", {
        diver: diver.value.trim(),
        expected: gesture.value,
        clip_id: clip.value,
      });
      answer.replaceChildren(...feedback(found));
      await load();
    } catch (error) {
      answer.replaceChildren();
      complain(error, "Recognition");
    }
    draw();
  };
  section.append(
    h(
      "div",
      { className: "practice-page" },
      h("h1", {}, "Practice"),
      h(
        "p",
        { className: "dim" },
        "Show a gesture, and read what to change. The record says when a diver\u2019s error rate is proved to be low enough for a dive.",
      ),
      form,
      answer,
      h("h2", {}, "Records"),
      records,
    ),
  );
  takeFilesIn("practice", (files) => addFiles(files));
  follow(["gestures", "clips"], draw);
  follow(["view", "gestures"], load);
}
