// The panel of the demonstration: its clip, its take, its frames, and its two ends to move.

import { filmstrip } from "../clips/filmstrip.js";
import { olderClipsButton } from "../clips/older-clips.js";
import * as api from "../core/api.js";
import { h, icon } from "../core/dom.js";
import { moment } from "../core/format.js";
import { nearestFrame } from "../clips/frame-times.js";
import { endName, heldName, salutesIn, saluteWarning, takesLanguage } from "../clips/salutes.js";
import { state } from "../core/state.js";
import { attempt } from "../core/toasts.js";
import { framesOf, movedTo, takeOf, wholeOf } from "./demonstration-range.js";
import { change, draft, saved } from "./gesture-draft.js";
import { figure } from "../studio/pose-picture.js";
import { chosenIn } from "./salient-keypoints.js";

/** @import { Poses, Take, Timeline } from "../core/types.d.ts" */

/** @import { Proposal } from "./salient-keypoints.js" */

/**
 * The demonstration on display: from a clip, or as stored in the language.
 *
 * @typedef {{ id: string, poses: Poses, takes: Take[], timeline: Timeline } | { id: null, poses: Poses, takes: Take[] }} Source
 */

/** @typedef {"start" | "end"} End */

const BY_HAND = "by hand";

/**
 * Build the panel. `gesture` is null for a new one, `drawn` says that only its drawing is known;
 * `pick(landmark)` switches a keypoint.
 *
 * @param {{ language: string, gesture: string | null, drawn: boolean, pick: (landmark: string) => void }} about
 */
export function take({ language, gesture, drawn, pick }) {
  /** @type {Source | null} */
  let source = null;
  /** @type {string | null | undefined} */
  let opening; // the clip being loaded; null: as stored in the language
  let frame = 0;
  /** @type {string[]} */
  let chosen = [];
  let clock = 0; // of the animation that plays
  const picture = figure(pick);
  const clips = h("select", { id: "editor-clip", onchange: () => choose(clips.value) });
  const takes = h("select", {
    id: "editor-take",
    onchange: () => {
      if (source?.id && takes.value !== BY_HAND)
        change({ clip: wholeOf(source.id, source.takes, source.poses.time, Number(takes.value)) });
    },
  });
  const scrub = h("input", {
    type: "range",
    id: "editor-frame",
    min: 0,
    step: 1,
    oninput: () => go(Number(scrub.value)),
  });
  const clockText = h("output", { className: "num", for: "editor-frame" });
  const playing = h("button", { type: "button", className: "quiet icon", onclick: () => play() });
  const ends = /** @type {End[]} */ (["start", "end"]).map(edge);
  const strip = h(
    "div",
    { className: "track" },
    h("div", { className: "range" }),
    ends.map((each) => each.handle),
  );
  const transit = h("input", {
    type: "checkbox",
    id: "editor-transit",
    onchange: () => {
      const { clip } = draft();
      if (clip) change({ clip: { ...clip, keep_transit: !transit.checked } });
    },
  });
  const transitText = h("small", { className: "dim" });
  const trim = h(
    "div",
    { className: "trim" },
    strip,
    h(
      "div",
      { className: "ends" },
      ends.map((each) => each.row),
    ),
    h(
      "label",
      { className: "check" },
      transit,
      h(
        "span",
        {},
        `Leave out the hand\u2019s transit from and to the ${endName(state.gestures)}`,
        transitText,
      ),
    ),
  );
  const note = h("p", { className: "dim" });
  const salutes = h("p", { className: "salute-warning", role: "alert", hidden: true });
  const faults = h("p", { className: "salute-warning", role: "status", hidden: true });
  const played = h(
    "div",
    { className: "scrub" },
    playing,
    h("label", { className: "visually-hidden", for: "editor-frame" }, "Frame"),
    scrub,
    clockText,
  );

  /** @param {End} which */
  function edge(which) {
    const title = which === "start" ? "Start" : "End";
    const handle = h("input", {
      type: "range",
      className: `handle ${which}`,
      min: 0,
      step: 1,
      "aria-label": `${title} of the demonstration`,
      title: `${title}: drag, or use the arrow keys, frame by frame`,
    });
    const number = h("input", { type: "number", id: `editor-${which}`, min: 0, step: 1 });
    const seconds = h("small", { className: "dim num" });
    handle.oninput = () => move(which, Number(handle.value));
    number.onchange = () => {
      if (number.value !== "") move(which, Math.round(Number(number.value)));
    };
    return {
      which,
      handle,
      number,
      seconds,
      row: h("div", {}, h("label", { for: number.id }, `${title} frame`), number, seconds),
    };
  }

  /**
   * @param {End} which
   * @param {number} to
   */
  function move(which, to) {
    const { clip } = draft();
    if (!source?.id || !clip) return;
    change({ clip: movedTo(clip, source.takes, source.poses.time, which, to) }, `trim ${which}`);
    const [first, last] = span();
    go(which === "start" ? first : last);
  }

  /** @type {() => [number, number]} */
  const span = () =>
    source ? framesOf(source.id ? draft().clip : null, source.takes, source.poses.time) : [0, 0];

  /** @param {string} id */
  async function choose(id) {
    if (!id) return change({ clip: null });
    if (id === saved().clip?.clip_id) return change({ clip: saved().clip });
    const loaded = await load(id);
    if (loaded) change({ clip: wholeOf(id, loaded.takes, loaded.poses.time) });
    return undefined;
  }

  /**
   * @param {string | null} id
   * @returns {Promise<Source | null>}
   */
  function load(id) {
    return attempt("Loading the demonstration", async () => {
      if (!id)
        return {
          id: null,
          takes: [],
          poses: await api.languages.demonstration(language, gesture ?? ""),
        };
      const [poses, found, timeline] = await Promise.all([
        api.clips.poses(id),
        api.clips.takes(id, takesLanguage(state.gestures)),
        api.clips.timeline(id, takesLanguage(state.gestures)),
      ]);
      return { id, poses, takes: found, timeline };
    });
  }

  /** @param {number} to */
  function go(to) {
    if (!source) return;
    frame = Math.max(0, Math.min(source.poses.time.length - 1, to));
    scrub.value = String(frame);
    clockText.textContent = `frame ${frame}, ${moment(source.poses.time[frame])}`;
    scrub.setAttribute("aria-valuetext", clockText.textContent);
    picture.draw(frame, span(), chosen);
  }

  /** Play the demonstration over and over, as fast as the camera saw it. */
  function play() {
    if (clock) return pause();
    if (!source) return undefined;
    const { time } = source.poses;
    let [first, last] = span();
    if (frame < first || frame >= last) go(first);
    const began = performance.now() - 1000 * (time[frame] - time[first]);
    /** @param {number} now */
    const step = (now) => {
      [first, last] = span();
      const length = time[last] - time[first] || 1;
      go(nearestFrame(time, time[first] + (((now - began) / 1000) % length)));
      clock = requestAnimationFrame(step);
    };
    clock = requestAnimationFrame(step);
    return drawPlaying();
  }

  function pause() {
    cancelAnimationFrame(clock);
    clock = 0;
    drawPlaying();
  }

  function drawPlaying() {
    playing.replaceChildren(icon(clock ? "pause" : "play"));
    playing.setAttribute("aria-label", clock ? "Pause" : "Play the demonstration");
    playing.title = `${clock ? "Pause" : "Play the demonstration"} (Space)`;
  }

  function drawChoices() {
    const ready = state.clips.filter((clip) => clip.status === "done");
    // The clip of the saved demonstration.
    const own = gesture ? (saved().clip?.clip_id ?? "") : null;
    const options = [
      ...(own === "" ? [["", "As it is saved"]] : []),
      ...ready.map((clip) => [clip.id, clip.id === own ? `${clip.name}, as saved` : clip.name]),
    ];
    clips.replaceChildren(...options.map(([value, text]) => h("option", { value }, text)));
    clips.value = draft().clip?.clip_id ?? "";
    const shown = source?.id ? source : null;
    /** @type {HTMLElement} */ (takes.parentElement).hidden = !shown;
    if (!shown) return;
    takes.replaceChildren(
      ...shown.takes.map((each, index) =>
        h(
          "option",
          { value: index },
          `Take ${index + 1}, ${moment(each.start)} to ${moment(each.end)}`,
        ),
      ),
      h("option", { value: BY_HAND }, "Range by hand"),
    );
    const taken = takeOf(draft().clip, shown.takes);
    takes.value = taken ? String(shown.takes.indexOf(taken)) : BY_HAND;
  }

  function drawTrim() {
    trim.hidden = !source?.id;
    if (!source?.id) return;
    const { time } = source.poses;
    const frames = span();
    ends.forEach(({ which, handle, number, seconds }, index) => {
      for (const input of [handle, number])
        Object.assign(input, { max: time.length - 1, value: frames[index] });
      handle.setAttribute(
        "aria-valuetext",
        `frame ${frames[index]}, ${moment(time[frames[index]])}`,
      );
      seconds.textContent = moment(time[frames[index]]);
      seconds.dataset.end = which;
    });
    /** @param {number} index */
    const share = (index) => (100 * index) / (time.length - 1);
    const range = /** @type {HTMLElement} */ (strip.querySelector(".range"));
    range.style.left = `${share(frames[0])}%`;
    range.style.width = `${share(frames[1]) - share(frames[0])}%`;
    const { clip } = draft();
    const own = takeOf(clip, source.takes);
    const warning = saluteWarning(
      own ? [] : salutesIn(source.timeline, time[frames[0]], time[frames[1]]),
      heldName(state.gestures),
    );
    salutes.textContent = warning;
    salutes.hidden = !warning;
    transit.disabled = !own;
    transit.checked = Boolean(own) && !clip?.keep_transit;
    transitText.textContent = own
      ? `${moment(own.stroke_start - own.start)} before and ${moment(own.end - own.stroke_end)} after the gesture`
      : "A range chosen by hand is used as it is; choose a take to have the transit found.";
  }

  const wantedClip = () => draft().clip?.clip_id ?? null;

  /** Show a demonstration: from a clip, or as stored in the language. */
  async function open() {
    const id = wantedClip();
    if ((source && source.id === id) || opening === id) return;
    if (clock) pause();
    opening = id;
    const none = id === null && (gesture === null || drawn);
    const loaded = none ? null : await load(id);
    if (opening !== id) return; // Another one is loading, or this one is already shown.
    opening = undefined;
    if (!loaded || wantedClip() !== id) {
      element.classList.toggle("bare", !loaded);
      return;
    }
    show(loaded);
  }

  /** @param {Source} loaded */
  function show(loaded) {
    source = loaded;
    const { id } = source;
    element.classList.remove("bare");
    const clip = state.clips.find((each) => each.id === id);
    picture.show(source.poses, clip ?? null);
    scrub.max = String(source.poses.time.length - 1);
    strip.querySelector(".filmstrip")?.remove();
    draw({ keypoints: chosen.map((landmark) => ({ landmark, proposed: true })) });
    go(span()[0]);
    if (clip && source.id && strip.clientWidth)
      strip.prepend(filmstrip(clip, source.timeline, strip.clientWidth, strip.clientHeight) ?? "");
  }

  /** @param {Proposal | null} preview */
  function draw(preview) {
    chosen = chosenIn(preview);
    const [fault] = preview?.faults ?? [];
    faults.textContent = fault?.sentence ?? "";
    faults.title = fault ? `It ${fault.words}.` : "";
    faults.hidden = !fault || !salutes.hidden;
    drawChoices();
    note.textContent = draft().clip
      ? ""
      : drawn
        ? "Imported without its demonstration: it cannot be played or trimmed, and its keypoints cannot be changed. Choose a clip that shows the gesture."
        : "The demonstration as it is saved in the language; its clip is not in this studio. To trim or replace it, choose a clip.";
    note.hidden = Boolean(draft().clip);
    drawTrim();
    if (source) go(frame);
    return open();
  }
  drawPlaying();
  const element = h(
    "section",
    { className: "panel take-panel", "aria-label": "Demonstration" },
    h(
      "div",
      { className: "panel-head" },
      h("h2", {}, "Demonstration"),
      h(
        "span",
        { className: "choose" },
        h("label", { className: "visually-hidden", for: "editor-clip" }, "Clip"),
        clips,
        olderClipsButton(drawChoices),
      ),
      h(
        "span",
        { className: "choose" },
        h("label", { className: "visually-hidden", for: "editor-take" }, "Take"),
        takes,
      ),
    ),
    picture.element,
    played,
    note,
    salutes,
    faults,
    trim,
  );
  return {
    element,
    draw,
    play,
    pause,
    /** @param {number} by */
    step: (by) => go(frame + by),
    /** @param {End} which */
    setHere: (which) => move(which, frame),
  };
}
