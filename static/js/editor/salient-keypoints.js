// The choice of salient keypoints: for each a checkbox, and a bar that shows how far it moves.

import { readable } from "../core/format.js";
import { buttonOf, html, live, repeat } from "../templates.js";
import { change, draft } from "./gesture-draft.js";

/** @import { DemonstrationFault, Keypoint, Preview } from "../core/types.d.ts" */

/** @typedef {{ keypoints: Pick<Keypoint, "landmark" | "proposed">[], faults?: DemonstrationFault[] }} Proposal */

/**
 * The keypoints that are followed: as chosen, or as proposed.
 *
 * @param {Proposal | null} preview
 */
export function chosenIn(preview) {
  return (
    draft().salient ??
    (preview?.keypoints ?? []).filter((each) => each.proposed).map((each) => each.landmark)
  );
}

/**
 * Switch a keypoint on or off. The last one stays on: a gesture needs at least one.
 *
 * @param {string} landmark
 * @param {Proposal | null} preview
 */
export function toggle(landmark, preview) {
  const chosen = chosenIn(preview);
  const next = chosen.includes(landmark)
    ? chosen.filter((each) => each !== landmark)
    : [...chosen, landmark].sort();
  if (next.length) change({ salient: next });
  return next.length > 0;
}

/**
 * The legend of the bars, or why there are none.
 *
 * @param {Preview | null} preview
 * @param {number} count
 */
function noteOn(preview, count) {
  if (!preview) return "\u2026";
  if (preview.image && !preview.problem && !preview.salient.length) {
    const gesture =
      preview.held_shapes > 1
        ? "two hand shapes one after the other are the gesture"
        : "the shape of the hand is the gesture";
    return `Nothing moves: ${gesture}. To follow a movement instead, choose keypoints.`;
  }
  if (count) {
    const unit = preview.unit === "torso_length" ? "torso lengths" : "shares of the largest extent";
    return `Movement in ${unit}. From the line, ${(preview.threshold ?? 0).toFixed(2)}, a keypoint is proposed.`;
  }
  if (draft().clip)
    return "No keypoint is seen in this range of the clip: choose another range, or another clip.";
  return "Imported without its demonstration: its keypoints cannot be changed. Choose a clip that shows the gesture.";
}

/**
 * @param {Keypoint} keypoint
 * @param {{ most: number, threshold: number, on: boolean, pick: () => void }} about
 */
function row({ landmark, displacement, seen, proposed }, { most, threshold, on, pick }) {
  const name = readable(landmark);
  const visible = seen < 1 ? `, seen ${Math.round(100 * seen)} % of the time` : "";
  return html`<li
    class=${on ? "on" : ""}
    title="${name} moves ${displacement.toFixed(2)}${visible}${proposed ? "; proposed" : ""}"
  >
    <label>
      <input type="checkbox" .checked=${live(on)} @change=${pick} />
      <span class="name">${name}</span>
      <span class="bar-track"
        ><i class="fill" .style=${`width: ${(100 * displacement) / most}%`}></i
        ><i class="mark" .style=${`left: ${(100 * threshold) / most}%`}></i
      ></span>
      <span class="num">${displacement.toFixed(2)}</span>
    </label>
  </li>`;
}

/**
 * The list of keypoints, and what moves.
 *
 * @param {Preview | null} preview
 * @param {{ all: boolean, refused: boolean }} shown whether all are listed, and whether the last
 *   one was to be left out
 * @param {() => void} draw
 */
export function keypoints(preview, shown, draw) {
  const found = preview?.keypoints ?? [];
  const chosen = chosenIn(preview);
  const threshold = preview?.threshold ?? 0;
  const most = Math.max(threshold, ...found.map((each) => each.displacement)) * 1.04 || 1;
  shown.refused &&= chosen.length < 2;
  /** @param {string} landmark */
  const pick = (landmark) => {
    shown.refused = !toggle(landmark, preview);
    draw();
  };
  const turn = () => {
    shown.all = !shown.all;
    draw();
  };
  return html`<section class="panel keypoints" aria-label="Salient keypoints">
    <div class="panel-head">
      <h2>Salient keypoints</h2>
      ${buttonOf("As proposed", () => change({ salient: null }), {
        disabled: draft().salient === null || !found.length,
      })}
    </div>
    <p class="dim">${noteOn(preview, found.length)}</p>
    <ul class="bars" aria-label="Keypoints">
      ${repeat(
        found.filter(
          (each) => shown.all || each.usual || each.proposed || chosen.includes(each.landmark),
        ),
        ({ landmark }) => landmark,
        (each) =>
          row(each, {
            most,
            threshold,
            on: chosen.includes(each.landmark),
            pick: () => pick(each.landmark),
          }),
      )}
    </ul>
    <p class="field-problem" role="alert" ?hidden=${!shown.refused}>
      At least one keypoint is followed; choose another one first.
    </p>
    <button type="button" class="link" ?hidden=${!found.length} @click=${turn}>
      ${shown.all ? "Fewer keypoints" : `All ${found.length} keypoints`}
    </button>
  </section>`;
}
