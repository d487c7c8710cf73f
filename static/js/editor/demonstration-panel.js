// The panel of the demonstration: its clip, its take, its frames, and its two ends to move.

import { filmstrip } from "../clips/filmstrip.js";
import { olderClipsButton } from "../clips/older-clips.js";
import * as api from "../core/api.js";
import { h } from "../core/dom.js";
import { moment } from "../core/format.js";
import { nearestFrame } from "../clips/frame-times.js";
import { endName, heldName, salutesIn, saluteWarning, takesLanguage } from "../clips/salutes.js";
import { state } from "../core/state.js";
import { attempt } from "../core/toasts.js";
import { framesOf, movedTo, takeOf, wholeOf } from "./demonstration-range.js";
import { change, draft, saved } from "./gesture-draft.js";
import { figure } from "../studio/pose-picture.js";
import { html, iconOf, ifDefined, live, nothing, optionsOf, render } from "../templates.js";
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
  /** @type {Proposal | null} */
  let proposal = null;
  let clock = 0; // of the animation that plays
  /** @type {HTMLElement | null} */
  let thumbnails = null;
  const element = h("section", { className: "panel take-panel", "aria-label": "Demonstration" });
  const picture = figure(pick);
  const older = olderClipsButton(() => redraw());

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
    redraw();
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
    return redraw();
  }

  function pause() {
    cancelAnimationFrame(clock);
    clock = 0;
    redraw();
  }

  function redraw() {
    render(panel(), element);
    if (source) picture.draw(frame, span(), chosenIn(proposal));
  }

  function panel() {
    const { clip } = draft();
    const note = drawn
      ? "Imported without its demonstration: it cannot be played or trimmed, and its keypoints cannot be changed. Choose a clip that shows the gesture."
      : "The demonstration as it is saved in the language; its clip is not in this studio. To trim or replace it, choose a clip.";
    return html`${head()}${picture.element}${scrub()}
      <p class="dim" ?hidden=${clip}>${clip ? "" : note}</p>
      ${warnings()}${source?.id ? trim(source) : nothing}`;
  }

  /** @type {() => [string, string][]} */
  function clipOptions() {
    const ready = state.clips.filter((clip) => clip.status === "done");
    // The clip of the saved demonstration.
    const own = gesture ? (saved().clip?.clip_id ?? "") : null;
    return [
      .../** @type {[string, string][]} */ (own === "" ? [["", "As it is saved"]] : []),
      ...ready.map(
        ({ id, name }) =>
          /** @type {[string, string]} */ ([id, id === own ? `${name}, as saved` : name]),
      ),
    ];
  }

  function takeChoice() {
    if (!source?.id) return nothing;
    const { id, takes, poses } = source;
    const taken = takeOf(draft().clip, takes);
    /** @type {[string, string][]} */
    const options = takes.map(({ start, end }, index) => [
      String(index),
      `Take ${index + 1}, ${moment(start)} to ${moment(end)}`,
    ]);
    const value = taken ? String(takes.indexOf(taken)) : BY_HAND;
    /** @param {string} chosen */
    const pickTake = (chosen) => {
      if (chosen !== BY_HAND) change({ clip: wholeOf(id, takes, poses.time, Number(chosen)) });
    };
    return html`<span class="choose">
      <label class="visually-hidden" for="editor-take">Take</label>
      <select id="editor-take" @change=${(/** @type {any} */ { target }) => pickTake(target.value)}>
        ${optionsOf([...options, [BY_HAND, "Range by hand"]], value)}
      </select>
    </span>`;
  }

  const head = () =>
    html`<div class="panel-head">
      <h2>Demonstration</h2>
      <span class="choose">
        <label class="visually-hidden" for="editor-clip">Clip</label>
        <select id="editor-clip" @change=${(/** @type {any} */ { target }) => choose(target.value)}>
          ${optionsOf(clipOptions(), wantedClip() ?? "")}</select
        >${older}
      </span>
      ${takeChoice()}
    </div>`;

  function scrub() {
    const time = source?.poses.time;
    const text = time && `frame ${frame}, ${moment(time[frame])}`;
    const label = clock ? "Pause" : "Play the demonstration";
    return html`<div class="scrub">
      <button
        type="button"
        class="quiet icon"
        aria-label=${label}
        title="${label} (Space)"
        @click=${play}
      >
        ${iconOf(clock ? "pause" : "play")}
      </button>
      <label class="visually-hidden" for="editor-frame">Frame</label>
      <input
        type="range"
        id="editor-frame"
        min="0"
        step="1"
        max=${ifDefined(time && time.length - 1)}
        aria-valuetext=${ifDefined(text)}
        .value=${live(String(frame))}
        @input=${(/** @type {any} */ { target }) => go(Number(target.value))}
      />
      <output class="num" for="editor-frame">${text}</output>
    </div>`;
  }

  function warnings() {
    const [fault] = proposal?.faults ?? [];
    const byHand = source?.id && !takeOf(draft().clip, source.takes) ? source : null;
    const [first, last] = span().map((each) => byHand?.poses.time[each] ?? 0);
    const warning =
      byHand && saluteWarning(salutesIn(byHand.timeline, first, last), heldName(state.gestures));
    return html`<p class="salute-warning" role="alert" ?hidden=${!warning}>${warning}</p>
      <p
        class="salute-warning"
        role="status"
        title=${fault ? `It ${fault.words}.` : ""}
        ?hidden=${!fault || warning}
      >
        ${fault?.sentence}
      </p>`;
  }

  /**
   * One end of the range: its handle on the thumbnails, and its number.
   *
   * @param {End} which
   * @param {number} at
   * @param {number[]} time
   */
  function edge(which, at, time) {
    const title = which === "start" ? "Start" : "End";
    const typed = (/** @type {any} */ { target }) => {
      if (target.value !== "") move(which, Math.round(Number(target.value)));
    };
    const handle = html`<input
      type="range"
      class="handle ${which}"
      min="0"
      step="1"
      max=${time.length - 1}
      aria-label="${title} of the demonstration"
      title="${title}: drag, or use the arrow keys, frame by frame"
      aria-valuetext="frame ${at}, ${moment(time[at])}"
      .value=${live(String(at))}
      @input=${typed}
    />`;
    const row = html`<div>
      <label for="editor-${which}">${title} frame</label>
      <input
        type="number"
        id="editor-${which}"
        min="0"
        step="1"
        max=${time.length - 1}
        .value=${live(String(at))}
        @change=${typed}
      />
      <small class="dim num" data-end=${which}>${moment(time[at])}</small>
    </div>`;
    return { handle, row };
  }

  /** @param {Source} shown */
  function trim({ takes, poses: { time } }) {
    const { clip } = draft();
    const [start, end] = span();
    const own = takeOf(clip, takes);
    const ends = [edge("start", start, time), edge("end", end, time)];
    /** @param {number} at */
    const share = (at) => (100 * at) / (time.length - 1);
    const transit = own
      ? `${moment(own.stroke_start - own.start)} before and ${moment(own.end - own.stroke_end)} after the gesture`
      : "A range chosen by hand is used as it is; choose a take to have the transit found.";
    const keep = (/** @type {any} */ { target }) =>
      clip && change({ clip: { ...clip, keep_transit: !target.checked } });
    return html`<div class="trim">
      <div class="track">
        ${thumbnails}
        <div
          class="range"
          .style=${`left: ${share(start)}%; width: ${share(end) - share(start)}%`}
        ></div>
        ${ends.map(({ handle }) => handle)}
      </div>
      <div class="ends">${ends.map(({ row }) => row)}</div>
      <label class="check">
        <input
          type="checkbox"
          id="editor-transit"
          ?disabled=${!own}
          .checked=${live(Boolean(own) && !clip?.keep_transit)}
          @change=${keep}
        />
        <span
          >Leave out the hand’s transit from and to the ${endName(state.gestures)}<small class="dim"
            >${transit}</small
          ></span
        >
      </label>
    </div>`;
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
    thumbnails = null;
    element.classList.remove("bare");
    const clip = state.clips.find((each) => each.id === source?.id);
    picture.show(source.poses, clip ?? null);
    go(span()[0]);
    const track = element.querySelector(".track");
    if (!clip || !source.id || !track) return;
    thumbnails = filmstrip(clip, source.timeline, track.clientWidth, track.clientHeight);
    redraw();
  }

  return {
    element,
    /** @param {Proposal | null} preview */
    draw: (preview) => {
      proposal = preview ?? proposal;
      redraw();
      return open();
    },
    play,
    pause,
    /** @param {number} by */
    step: (by) => go(frame + by),
    /** @param {End} which */
    setHere: (which) => move(which, frame),
  };
}
