// The explanation of a recognition: its cause, the differences in time, and counterfactuals.

import * as api from "../core/api.js";
import { byId } from "../core/dom.js";
import { moment, readable } from "../core/format.js";
import { nearestFrame } from "../clips/frame-times.js";
import { mcapExport } from "../clips/mcap-export.js";
import { isReadable, state, update } from "../core/state.js";
import { attempt, toast } from "../core/toasts.js";
import { go } from "../core/views.js";
import { openDemonstrations } from "../gestures/demonstrations-dialog.js";
import { addToTestSet, expectedOf } from "../languages/test-set.js";
import { buttonOf, html, ifDefined, nothing, render, svg } from "../templates.js";
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
  const share = (seconds) => Number(((1000 * seconds) / last).toFixed(1));
  const bars = steps.map((step, index) => {
    const from = share(index ? (time[index - 1] + time[index]) / 2 : time[index]);
    const to = share(index + 1 < time.length ? (time[index] + time[index + 1]) / 2 : time[index]);
    const amount = Math.sqrt(step[part] / most);
    return svg`<rect
      x=${from}
      width=${Math.max(0.5, to - from)}
      y=${LANE * (1 - amount)}
      height=${LANE * amount}
      fill-opacity=${(0.35 + 0.65 * amount).toFixed(2)}
    />`;
  });
  const differs =
    marked &&
    svg`<rect
      class="differs"
      x=${share(marked.start)}
      width=${share(marked.end) - share(marked.start)}
      height=${LANE}
    />`;
  return html`<div class="cost-lane">
    <svg
      viewBox="0 0 1000 ${LANE}"
      preserveAspectRatio="none"
      role="img"
      aria-label="Difference of the ${readable(name)} along the clip"
    >
      ${differs}${bars}</svg
    ><span>${readable(name)}</span>
  </div>`;
}

/**
 * Draw, under the curves, when and in which joint the take differs from the expected gesture.
 *
 * @param {State} state
 */
export function drawCosts({ why, result, timeline }) {
  const box = byId("costs");
  const found = why && !why.right && result?.expected ? costs(why) : null;
  if (!timeline || !found?.lanes.length) return render(nothing, box);
  const most =
    Math.max(...found.lanes.flatMap(({ part }) => found.steps.map((step) => step[part]))) || 1;
  return render(
    html`<p class="cost-title">Where it differs from <b class="expected">${found.label}</b></p>
      ${found.lanes.map((each) => lane(found, each, most, timeline.time.at(-1) || 1))}`,
    box,
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
 * The exports: the take as a page for people without a studio, the whole clip for robot tools.
 *
 * @param {Recognition} result
 * @param {Explanation | null} why
 */
function shares(result, why) {
  const page = html`<span
    ><a href=${api.recognitions.analysisUrl(result.id)} download="">Share as one file</a
    ><small class="dim"> plays without a server</small></span
  >`;
  const test = html`<span
    >${buttonOf("Keep as a test", () => keepAsTest(result), { look: "link", writes: true })}<small
      class="dim"
    >
      recognised again after every change</small
    ></span
  >`;
  return html`<p class="share">
    ${why && page}${expectedOf(result) === null || result.trial ? nothing : test}${mcapExport(
      result.clip_id,
    )}
  </p>`;
}

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
const note = (text) => html`<p class="dim">${text}</p>`;

/**
 * A button within a sentence; its text is a property, so that there are no spaces around it.
 *
 * @param {string} words
 * @param {() => unknown} run
 * @param {string} [look]
 * @param {string} [title]
 */
const link = (words, run, look = "", title = undefined) =>
  html`<button
    type="button"
    class="link ${look}"
    title=${ifDefined(title)}
    .textContent=${words}
    @click=${run}
  ></button>`;

/** @param {number} seconds */
function goTo(seconds) {
  if (state.timeline) seek(nearestFrame(state.timeline.time, seconds));
}

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
  const start = cause?.start ?? null;
  return start === null ? nothing : link(`Go to ${moment(start)}`, () => goTo(start));
}

/**
 * The one thing to do: the best change as a button that tries it; nothing where none helps.
 *
 * @param {Explanation} why
 */
function remedyOf({ right, expected, counterfactuals: [best] }) {
  if (right || !best) return nothing;
  const isFurther = best.change.kind === "further_demonstration";
  // As a demonstration the take is read without itself.
  const what = isFurther ? "Other takes are read better" : `Recognised as ${expected}`;
  return html`<p class="remedies">
    ${what}
    <button type="button" @click=${() => tryOut(best)}>${best.change.words}</button>
    <small class="dim num">${effectOf(best.effect)}</small>
  </p>`;
}

/**
 * Words of a line that tells strokes: those of the take go to their moment.
 *
 * @param {Words} words
 * @returns {unknown}
 */
function drawn({ text, start, differs, bridged, folded }) {
  if (folded.length)
    return html`<details>
      <summary>${text}</summary>
      ${folded.map(drawn)}
    </details>`;
  const look = `${differs ? "differs" : ""} ${bridged ? "bridged" : ""}`;
  const title = bridged ? "The hand jumped here: its path is bridged by a line." : undefined;
  return start === null
    ? html`<span class=${look} title=${ifDefined(title)}>${text}</span>`
    : link(text, () => goTo(start), look, title);
}

/**
 * The strokes of both in words; without a cause they are the sentence.
 *
 * @param {Explanation} why
 */
const transcriptOf = ({ causes, strokes }) =>
  html`<div
    class="transcript ${causes.length ? "" : "why-sentence"}"
    role="group"
    aria-label="Strokes in words"
  >
    ${strokes.map((line) => html`<p>${line.map(drawn)}</p>`)}
  </div>`;

/** @param {Explanation} why */
function reasons(why) {
  const { causes, strokes, sentence, notes, details } = why;
  return html`${
      strokes.length && !causes.length
        ? nothing
        : html`<p class="why-sentence">${sentence} ${placeOf(why)}</p>`
    }${strokes.length ? transcriptOf(why) : nothing}${
      notes.length
        ? html`<ul class="why-notes">
            ${notes.map((text) => html`<li>${text}</li>`)}
          </ul>`
        : nothing
    }${remedyOf(why)}
    <details class="why-details">
      <summary>Numbers</summary>
      <ul>
        ${details.map((line) => html`<li class="num">${line}</li>`)}
      </ul>
    </details>`;
}

/**
 * The question which gesture was meant; an answer shows the explanation at once.
 *
 * @param {string[]} labels
 */
const askExpected = (labels) =>
  html`${note("Was another gesture meant? Choose it to see why, and which change would help.")}
    <div class="meant" role="group" aria-label="Gesture that was meant">
      ${labels.map((label) => buttonOf(label, () => recogniseWith({ expected: label })))}
    </div>`;

/**
 * The question which gesture was meant, or what helps where none was.
 *
 * @param {Recognition} result
 */
function whatWasMeant({ expected_none: none, label, gestures }) {
  if (!none) return askExpected(gestures);
  return label === null ? nothing : note("The dial in Health decides how many takes are refused.");
}

/**
 * Whether it is asked which gesture was meant, instead of saying why.
 *
 * @param {Recognition} result
 * @param {State["trial"]} trial
 */
const isAsked = (result, trial) =>
  result.expected_none || (expectedOf(result) === null && trial?.result !== result.id);

/**
 * Draw the explanation beside the take, and the moments that correspond under it.
 *
 * @param {State} state
 */
export function drawWhy({ why, result, trial }) {
  const [box, moments] = [byId("why"), byId("correspondences")];
  const shown = isReadable() ? result : null; // Without a result the decision says what to do.
  byId("reasons").hidden = !isReadable();
  box.hidden = !shown;
  const told = !shown || isAsked(shown, trial) ? null : why;
  const alignments = alignmentsOf(told);
  moments.hidden = !alignments;
  render(alignments, moments);
  if (!shown) return render(nothing, box);
  const trying = trial?.result === shown.id ? trialBar(trial, shown) : nothing;
  const words = isAsked(shown, trial) ? whatWasMeant(shown) : [trying, told && reasons(told)];
  return render(html`<div class="why-words">${words}${shares(shown, told)}</div>`, box);
}
