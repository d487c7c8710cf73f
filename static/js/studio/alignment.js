// The alignment of the take with two gestures: their paths, and which moments correspond.

import { h, svg as svgElement } from "../core/dom.js";
import { moment, readable } from "../core/format.js";
import { nearestFrame } from "../clips/frame-times.js";
import { state, update } from "../core/state.js";
import { html, nothing, optionsOf, render, svg } from "../templates.js";
import { chooseJoint, partsOf, roleOf, sum } from "./alignment-parts.js";
import { seek } from "./playback.js";

/** @import { Alignment, Explanation, Piece, Place, State } from "../core/types.d.ts" */

/** @typedef {{ left: number, top: number, width: number, height: number }} Box */

const MARGIN = 0.12; // of the longer side, around all that moves
const LETTERS = 0.075; // height of a number in the drawing, as a share of it

/** @param {number} share */
const percent = (share) => `${(100 * share).toFixed(share < 0.1 ? 1 : 0)} %`;

/** @type {{ joint: string, draw: () => void, show: (seconds: number) => void } | null} */
let follower = null; // Moves the cursor of the drawings on display.
/** @type {string | null} */
let shown = null; // The joint drawn last; kept for another recognition of the take.

/**
 * The alignments of the paths, the one with the expected gesture first.
 *
 * @param {Explanation} why
 */
const pathsOf = (why) => why.alignments.filter(({ voter, query }) => voter === "path" && query);

/**
 * The box around a joint's paths in all the drawings, so that all have one scale.
 *
 * @param {Alignment[]} alignments
 * @param {number} part
 * @returns {Box | null}
 */
function boxOf(alignments, part) {
  const places = alignments
    .flatMap(({ query, gesture }) => [...query, ...gesture].map((step) => step[part]))
    .filter((place) => place !== null);
  if (!places.length) return null;
  const [xs, ys] = [places.map(([x]) => x), places.map(([, y]) => y)];
  const [width, height] = [Math.max(...xs) - Math.min(...xs), Math.max(...ys) - Math.min(...ys)];
  const margin = MARGIN * Math.max(width, height, 0.1);
  return {
    left: Math.min(...xs) - margin,
    top: Math.min(...ys) - margin,
    width: width + 2 * margin,
    height: height + 2 * margin,
  };
}

/** @param {NonNullable<Place>} place */
const at = ([x, y]) => `${x.toFixed(3)} ${y.toFixed(3)}`;
/**
 * @param {Place[][]} steps
 * @param {number} part
 */
const line = (steps, part) =>
  steps
    .map((step) => step[part])
    .filter((place) => place !== null)
    .map((place, index) => `${index ? "L" : "M"}${at(place)}`)
    .join("");
/**
 * @param {Place} from
 * @param {Place} to
 */
const between = (from, to) => (from && to ? `M${at(from)}L${at(to)}` : "");
// A line without length has round ends: a dot.
/** @param {Place} place */
const dot = (place) => (place ? `M${at(place)}h0` : "");

/**
 * The cost of each pair of moments at one joint, as a share of the whole distance.
 *
 * @param {Alignment} alignment
 * @param {number} part
 */
function sharesOf({ costs, distance }, part) {
  return costs.map((step) => step[part] / (distance || 1));
}

/**
 * @param {Alignment} alignment
 * @param {number} part
 * @param {number[]} shares
 */
function drawnLinks({ pairs, query, gesture }, part, shares) {
  const most = Math.max(...shares) || 1;
  return pairs.map(([one, other], index) => {
    const amount = Math.sqrt(shares[index] / most);
    return svg`<path
      class="link"
      d=${between(query[one][part], gesture[other][part])}
      stroke-width=${(0.5 + 3 * amount).toFixed(2)}
      stroke-opacity=${(0.25 + 0.75 * amount).toFixed(2)}
    />`;
  });
}

/**
 * The number at the pair that costs most.
 *
 * @param {Alignment} alignment
 * @param {number} part
 * @param {number[]} shares
 * @param {Box} box
 */
function worst({ pairs, query, gesture }, part, shares, box) {
  const index = shares.indexOf(Math.max(...shares));
  const [one, other] = [query[pairs[index][0]][part], gesture[pairs[index][1]][part]];
  if (!one || !other || !shares[index]) return nothing;
  const [x, y] = [(one[0] + other[0]) / 2, (one[1] + other[1]) / 2];
  const onTheRight = x > box.left + 0.6 * box.width;
  const size = LETTERS * Math.max(box.width, box.height);
  return svg`<text
    x=${x + (onTheRight ? -size / 2 : size / 2)}
    y=${y}
    font-size=${size}
    text-anchor=${onTheRight ? "end" : "start"}
  >${percent(shares[index])}</text>`;
}

/**
 * Go to the moment of the take that is nearest to where the drawing was pressed.
 *
 * @param {MouseEvent & { currentTarget: any }} event
 * @param {Alignment} alignment
 * @param {number} part
 */
function seekByPress({ currentTarget, clientX, clientY }, { query, time }, part) {
  const point = new DOMPoint(clientX, clientY).matrixTransform(
    currentTarget.getScreenCTM()?.inverse(),
  );
  const far = query.map((step) =>
    step[part] ? Math.hypot(step[part][0] - point.x, step[part][1] - point.y) : Infinity,
  );
  if (state.timeline) seek(nearestFrame(state.timeline.time, time[far.indexOf(Math.min(...far))]));
}

/**
 * The first stroke that differs, on the path of the take and on that of the expected gesture.
 *
 * @param {Alignment} alignment
 * @param {number} part
 * @param {Explanation} why
 */
function differing({ label, query, time, gesture, gesture_time }, part, why) {
  const { shown, expected, differs, differs_in_expected: theirs } = why.transcript;
  if (differs === null || theirs === null || label !== why.expected) return [];
  /** @type {[Place[][], number[], Piece | undefined][]} */
  const both = [
    [query, time, shown[differs]],
    [gesture, gesture_time, expected[theirs]],
  ];
  return both.map(([steps, times, piece]) => {
    const within = steps.filter(
      (_, step) => piece && times[step] >= piece.start && times[step] <= piece.end,
    );
    return svg`<path class="differs" d=${line(within, part)} />`;
  });
}

/** @param {Alignment} alignment */
const asCompared = ({ mirrored, backward }) =>
  [mirrored ? "as its mirror image" : "", backward ? "from its end" : ""]
    .filter(Boolean)
    .join(", ");

/**
 * Draw one alignment at one joint; `show(seconds)` moves its cursor.
 *
 * @param {Alignment} alignment
 * @param {number} part
 * @param {Box} box
 * @param {Explanation} why
 */
function drawn(alignment, part, box, why) {
  const { label, pairs, time, gesture_time: theirs, query, gesture, parts } = alignment;
  const shares = sharesOf(alignment, part);
  const role = roleOf(label, why);
  const kind = role === "expected" ? "expected" : "chosen";
  const most = shares.indexOf(Math.max(...shares));
  const [link, mine, other] = ["now-link", "now-mine", `now-${kind}`].map((name) =>
    svgElement("path", { class: name, d: "" }),
  );
  const words = h("p", { className: "at dim" });
  const about = `The ${readable(parts[part])} in this take and in ${label}. They differ most at ${moment(time[pairs[most][0]])}: ${percent(shares[most])} of all that differs`;
  const figure = html`<figure>
    <figcaption>
      <i class=${kind}></i><b class=${kind} title=${label}>${label}</b
      ><span class="dim">${[role, asCompared(alignment)].filter(Boolean).join(", ")}</span
      ><span class="num">distance ${alignment.distance.toFixed(3)}</span>
    </figcaption>
    <svg
      class="alignment"
      viewBox="${box.left} ${box.top} ${box.width} ${box.height}"
      role="img"
      aria-label=${about}
      @click=${(/** @type {any} */ event) => seekByPress(event, alignment, part)}
    >
      ${drawnLinks(alignment, part, shares)}
      <path class="theirs ${kind}" d=${line(gesture, part)} />
      <path class="mine" d=${line(query, part)} />
      ${differing(alignment, part, why)}
      <path class="begin ${kind}" d=${dot(gesture[0][part])} />
      <path class="begin" d=${dot(query[0][part])} />
      ${link}${other}${mine}${worst(alignment, part, shares, box)}
    </svg>
    ${words}
  </figure>`;
  /** @param {number} seconds */
  const show = (seconds) => {
    const step = nearestFrame(time, seconds);
    const here = pairs.flatMap(([one], index) => (one === step ? [index] : []));
    const they = here.map((index) => gesture[pairs[index][1]][part]);
    link.setAttribute("d", they.map((place) => between(query[step][part], place)).join(""));
    mine.setAttribute("d", dot(query[step][part]));
    other.setAttribute("d", they.map(dot).join(""));
    words.textContent = `${moment(time[step])} with ${moment(theirs[pairs[here[0]][1]])} of ${label}: ${percent(sum(here.map((index) => shares[index])))}`;
  };
  return { figure, show };
}

/**
 * Draw which moments correspond; null if there are no paths to compare.
 *
 * @param {Explanation | null} why
 */
export function alignmentsOf(why) {
  follower = null;
  if (!why) return null;
  const alignments = pathsOf(why);
  if (!alignments.length) return null;
  const box = h("section", { className: "alignments", "aria-label": "Which moments correspond" });
  const draw = () => {
    const parts = partsOf(alignments[0]);
    const chosen = chooseJoint(parts, alignments, state.joint, shown);
    shown = chosen.name;
    const around = boxOf(alignments, chosen.part);
    const figures = around ? alignments.map((each) => drawn(each, chosen.part, around, why)) : [];
    /** @type {[string, string][]} */
    const options = parts.map(({ name, share }) => [name, `${readable(name)}, ${percent(share)}`]);
    const pick = (/** @type {any} */ { target }) => update({ joint: target.value });
    render(
      html`<div class="alignments-head">
          <h2>Which moments correspond</h2>
          <select aria-label="Joint whose paths are drawn" @change=${pick}>
            ${optionsOf(options, chosen.name)}
          </select>
        </div>
        <div class="figures">${figures.map((each) => each.figure)}</div>
        <p class="dim">
          <i class="mine"></i>this take, from its dot on. The thicker the line between two moments,
          the more they differ; the number is their share of the distance.
        </p>`,
      box,
    );
    follower = {
      joint: chosen.name,
      draw,
      show: (seconds) => figures.forEach(({ show }) => show(seconds)),
    };
    showMoment();
  };
  draw();
  return box;
}

/** Follow the clock. */
export function showMoment() {
  if (follower && state.position) follower.show(state.position.time);
}

/**
 * Draw the joint that was chosen.
 *
 * @param {State} state
 */
export function showJoint({ joint }) {
  if (follower && joint && joint !== follower.joint) follower.draw();
}
