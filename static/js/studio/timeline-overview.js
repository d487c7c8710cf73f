// The whole clip in small above an enlarged timeline: its takes, and the part in sight.

import { h } from "../core/dom.js";

/** @import { Take } from "../core/types.d.ts" */

/** @type {(part: number, whole: number) => string} */
const share = (part, whole) => `${(100 * part) / whole}%`;

/**
 * Make the overview of a timeline that scrolls; a press or a drag moves the part in sight.
 *
 * @param {HTMLElement} seen
 */
export function overview(seen) {
  const bar = h("div", { className: "overview", "aria-hidden": "true", hidden: true });
  /** @param {PointerEvent} event */
  const to = (event) => {
    const { left, width } = bar.getBoundingClientRect();
    seen.scrollLeft = (seen.scrollWidth * (event.clientX - left)) / width - seen.clientWidth / 2;
  };
  bar.onpointerdown = (event) => {
    bar.setPointerCapture(event.pointerId);
    to(event);
    bar.onpointermove = to;
  };
  bar.onpointerup = bar.onpointercancel = () => {
    bar.onpointermove = null;
  };
  seen.addEventListener("scroll", () => drawInSight(seen, bar));
  return bar;
}

/**
 * Show which part is in sight.
 *
 * @param {HTMLElement} seen
 * @param {HTMLElement} bar
 */
function drawInSight(seen, bar) {
  const part = /** @type {HTMLElement | null} */ (bar.querySelector(".in-sight"));
  if (!part) return;
  part.style.left = share(seen.scrollLeft, seen.scrollWidth);
  part.style.width = share(seen.clientWidth, seen.scrollWidth);
}

/**
 * Draw the overview where the timeline is enlarged.
 *
 * @param {HTMLElement} box of the timeline
 * @param {Take[]} takes
 * @param {number} last second of the clip
 * @param {boolean} enlarged
 */
export function drawOverview(box, takes, last, enlarged) {
  const [bar, seen] = [".overview", ".seen"].map(
    (each) => /** @type {HTMLElement | null} */ (box.querySelector(each)),
  );
  if (!bar || !seen) return;
  bar.hidden = !enlarged;
  bar.replaceChildren(
    ...takes.map(({ start, end }) =>
      h("i", { style: { left: share(start, last), width: share(end - start, last) } }),
    ),
    h("i", { className: "in-sight" }),
  );
  drawInSight(seen, bar);
}
