// The explanation of a recognition: its cause, the differences in time, and counterfactuals.

import * as api from "../core/api.js";
import { byId, h, svg, WRITES } from "../core/dom.js";
import { moment, readable } from "../core/format.js";
import { nearestFrame } from "../clips/frame-times.js";
import { mcapExport } from "../clips/mcap-export.js";
import { isReadable, state, update } from "../core/state.js";
import { attempt, toast } from "../core/toasts.js";
import { go } from "../core/views.js";
import { openDemonstrations } from "../gestures/demonstrations-dialog.js";
import { addToTestSet, expectedOf } from "../languages/test-set.js";
import { alignmentsOf } from "./alignment.js";
import { partsOf } from "./alignment-parts.js";
import { trialBar, tryOut } from "./intervention-trial.js";
import { seek } from "./playback.js";
import { recogniseWith } from "./studio-view.js";

/** @import { Explanation, Recognition, SideEffect, State, Words } from "../core/types.d.ts" */

const MOST_PARTS = 3; // Joints shown over time: those with the highest cost.
const LANE = 14; // Height of a joint's lane, in the drawing's own units.

/**
 * Load the explanation by the expected gesture, or by the nearest one where none is expected.
 *
 * @param {Pick<State, "result">} state
 */
export async function loadWhy({ result }) {
  const label = result && (result.expected ?? result.nearest);
  if (!label) return update({ why: null });
  if (state.why?.id === result.id) return undefined;
  const why = await attempt("Explaining", () => api.recognitions.explain(result.id, label));
  // Another recognition may be on display by now, whose own reasons must stay.
  return state.result?.id === result.id ? update({ why }) : undefined;
}

/**
 * The DTW cost of each step of the take and joint, against the expected gesture.
 *
 * @param {Explanation} why
 */
function costs({ alignments, expected, transcript }) {
  const alignment = alignments.find((each) => each.label === expected && each.voter === "path");
  if (!alignment) return null;
  const steps = alignment.time.map(() => alignment.parts.map(() => 0));
  alignment.pairs.forEach(([step], index) =>
    alignment.costs[index].forEach((cost, part) => {
      steps[step][part] += cost;
    }),
  );
  const lanes = partsOf(alignment).filter(({ cost }) => cost > 0);
  const { shown, differs } = transcript;
  const marked = differs === null ? null : (shown[differs] ?? null);
  return {
    time: alignment.time,
    steps,
    lanes: lanes.slice(0, MOST_PARTS),
    label: expected,
    marked,
  };
}

/**
 * Draw the costs along the clip's time, as height and shade.
 *
 * @param {NonNullable<ReturnType<typeof costs>>} costs
 * @param {{ part: number, name: string }} lane
 * @param {number} most
 * @param {number} last
 */
function lane({ time, steps, marked }, { part, name }, most, last) {
  /** @param {number} seconds */
  const share = (seconds) => ((1000 * seconds) / last).toFixed(1);
  const bars = steps.map((step, index) => {
    const from = index ? (time[index - 1] + time[index]) / 2 : time[index];
    const to = index + 1 < time.length ? (time[index] + time[index + 1]) / 2 : time[index];
    const amount = Math.sqrt(step[part] / most);
    return svg("rect", {
      x: share(from),
      width: Math.max(0.5, Number(share(to)) - Number(share(from))),
      y: LANE * (1 - amount),
      height: LANE * amount,
      "fill-opacity": (0.35 + 0.65 * amount).toFixed(2),
    });
  });
  return h(
    "div",
    { className: "cost-lane" },
    svg(
      "svg",
      {
        viewBox: `0 0 1000 ${LANE}`,
        preserveAspectRatio: "none",
        role: "img",
        "aria-label": `Difference of the ${readable(name)} along the clip`,
      },
      ...(marked
        ? [
            svg("rect", {
              class: "differs",
              x: share(marked.start),
              width: Number(share(marked.end)) - Number(share(marked.start)),
              height: LANE,
            }),
          ]
        : []),
      ...bars,
    ),
    h("span", {}, readable(name)),
  );
}

/**
 * Draw, under the curves, when and in which joint the take differs from the expected gesture.
 *
 * @param {State} state
 */
export function drawCosts({ why, result, timeline }) {
  const box = byId("costs");
  const found = why && !why.right && result?.expected ? costs(why) : null;
  if (!timeline || !found?.lanes.length) return box.replaceChildren();
  const most =
    Math.max(...found.lanes.flatMap(({ part }) => found.steps.map((step) => step[part]))) || 1;
  return box.replaceChildren(
    h(
      "p",
      { className: "cost-title" },
      "Where it differs from ",
      h("b", { className: "expected" }, found.label),
    ),
    ...found.lanes.map((each) => lane(found, each, most, timeline.time.at(-1) || 1)),
  );
}

/**
 * The effect of an intervention on other takes whose gesture is known.
 *
 * @param {SideEffect | null} effect
 */
function effectOf(effect) {
  if (!effect) return "changes this take alone";
  const { takes, repaired, broken } = effect;
  if (!takes) return "untested: no other takes are known";
  return repaired || broken
    ? `repairs ${repaired}, breaks ${broken} of ${takes} other takes`
    : "repairs no other take";
}

/**
 * @param {string} href
 * @param {string} title
 * @param {string} note
 */
const shared = (href, title, note) =>
  h(
    "span",
    {},
    h("a", { href, download: "" }, title),
    h("small", { className: "dim" }, ` ${note}`),
  );

/**
 * The exports: the take as a page for people without a studio, the whole clip for robot tools.
 *
 * @param {Recognition} result
 * @param {Explanation | null} why
 */
const shares = (result, why) =>
  h(
    "p",
    { className: "share" },
    why
      ? shared(
          api.recognitions.analysisUrl(result.id),
          "Share as one file",
          "plays without a server",
        )
      : null,
    expectedOf(result) === null || result.trial
      ? null
      : h(
          "span",
          {},
          h(
            "button",
            { type: "button", className: "link", ...WRITES, onclick: () => keepAsTest(result) },
            "Keep as a test",
          ),
          h("small", { className: "dim" }, " recognised again after every change"),
        ),
    mcapExport(result.clip_id),
  );

/**
 * Keep the recognised range with its expected label as a test of the language.
 *
 * @param {Recognition} result
 */
async function keepAsTest(result) {
  const { clip_id, start, end } = result;
  const expected = expectedOf(result);
  if (expected === null) return;
  const kept = await attempt("Adding to the test set", async () => {
    await addToTestSet([{ clip_id, start, end, expected }]);
    return true;
  });
  if (kept)
    toast("In the test set", `It is recognised again after every change of the language.`, {
      action: { label: "Show", run: () => go("health") },
    });
}

/** @param {string} text */
const note = (text) => h("p", { className: "dim" }, text);

/**
 * @param {string} words
 * @param {() => unknown} onclick
 */
const link = (words, onclick) => h("button", { type: "button", className: "link", onclick }, words);

/**
 * A button that goes to a moment.
 *
 * @param {number} seconds
 * @param {string} words
 */
const goTo = (seconds, words) =>
  link(words, () => {
    if (state.timeline) seek(nearestFrame(state.timeline.time, seconds));
  });

/**
 * The button beside a cause: its demonstrations, the gestures that are alike, or its moment;
 * nothing where it lasts throughout.
 *
 * @param {Explanation} why
 */
function placeOf({ causes: [cause], blame: [blamed] }) {
  const label = blamed?.label ?? cause?.label;
  if (cause?.kind === "near_gesture") return link("Change one in Health", () => go("health"));
  if (label && (blamed || cause.kind === "demonstration"))
    return link("Show its demonstrations", () => openDemonstrations(label));
  return cause && cause.start !== null ? goTo(cause.start, `Go to ${moment(cause.start)}`) : null;
}

/**
 * The numbers behind the sentence, folded.
 *
 * @param {Explanation} why
 */
const detailsOf = ({ details }) =>
  h(
    "details",
    { className: "why-details" },
    h("summary", {}, "Numbers"),
    h(
      "ul",
      {},
      details.map((line) => h("li", { className: "num" }, line)),
    ),
  );

/**
 * The one thing to do: the best change as a button that tries it; nothing where none helps.
 *
 * @param {Explanation} why
 */
const remedyOf = ({ right, expected, counterfactuals: [best] }) =>
  right || !best
    ? null
    : h(
        "p",
        { className: "remedies" },
        // As a demonstration the take is read without itself.
        best.change.kind === "further_demonstration"
          ? "Other takes are read better "
          : `Recognised as ${expected} `,
        h("button", { type: "button", onclick: () => tryOut(best) }, best.change.words),
        h("small", { className: "dim num" }, ` ${effectOf(best.effect)}`),
      );

/**
 * Words of a line that tells strokes: those of the take go to their moment.
 *
 * @param {Words} words
 * @returns {HTMLElement}
 */
function drawn({ text, start, differs, bridged, folded }) {
  if (folded.length) return h("details", {}, h("summary", {}, text), folded.map(drawn));
  const marked = [differs ? "differs" : "", bridged ? "bridged" : ""].filter(Boolean);
  const told = start === null ? h("span", {}, text) : goTo(start, text);
  told.classList.add(...marked);
  if (bridged) told.title = "The hand jumped here: its path is bridged by a line.";
  return told;
}

/**
 * The strokes of both in words; without a cause they are the sentence.
 *
 * @param {Explanation} why
 */
const transcriptOf = ({ causes, strokes }) =>
  strokes.length
    ? h(
        "div",
        {
          className: causes.length ? "transcript" : "transcript why-sentence",
          role: "group",
          "aria-label": "Strokes in words",
        },
        strokes.map((line) => h("p", {}, line.map(drawn))),
      )
    : null;

/** @param {Explanation} why */
const notesOf = ({ notes }) =>
  notes.length
    ? h(
        "ul",
        { className: "why-notes" },
        notes.map((text) => h("li", {}, text)),
      )
    : null;

/** @param {Explanation} why */
function reasons(why) {
  const transcript = transcriptOf(why);
  return [
    transcript && !why.causes.length
      ? null
      : h("p", { className: "why-sentence" }, `${why.sentence} `, placeOf(why)),
    transcript,
    notesOf(why),
    remedyOf(why),
    detailsOf(why),
  ];
}

/**
 * The question which gesture was meant; an answer shows the explanation at once.
 *
 * @param {string[]} labels
 */
const askExpected = (labels) => [
  note("Was another gesture meant? Choose it to see why, and which change would help."),
  h(
    "div",
    { className: "meant", role: "group", "aria-label": "Gesture that was meant" },
    labels.map((label) =>
      h("button", { type: "button", onclick: () => recogniseWith({ expected: label }) }, label),
    ),
  ),
];

/**
 * The question which gesture was meant, or what helps where none was.
 *
 * @param {Recognition} result
 * @returns {(Node | string | null)[]}
 */
function whatWasMeant({ expected_none: none, label, gestures }) {
  if (!none) return askExpected(gestures);
  return label === null ? [] : [note("The dial in Health decides how many takes are refused.")];
}

/**
 * Draw the explanation beside the take, and the moments that correspond under it.
 *
 * @param {State} state
 */
export function drawWhy({ why, result, trial }) {
  const box = byId("why");
  const trying = trial && result?.id === trial.result ? trialBar(trial, result) : null;
  const done = isReadable();
  byId("reasons").hidden = !done;
  box.hidden = !done || !result; // Without a result the decision says what to do.
  if (!done || !result) {
    drawMoments(null);
    return box.replaceChildren();
  }
  const asked = result.expected_none || (expectedOf(result) === null && !trying);
  drawMoments(asked ? null : alignmentsOf(why));
  const words = asked ? whatWasMeant(result) : [trying, ...(why ? reasons(why) : [])];
  words.push(shares(result, asked ? null : why));
  return box.replaceChildren(h("div", { className: "why-words" }, words));
}

/**
 * Draw which moments correspond, under the picture.
 *
 * @param {ReturnType<typeof alignmentsOf>} alignments
 */
function drawMoments(alignments) {
  const box = byId("correspondences");
  box.hidden = !alignments;
  box.replaceChildren(...(alignments ? [alignments] : []));
}
