// The thumbnails of a clip along its time.

import * as api from "../core/api.js";
import { h } from "../core/dom.js";

/** @import { Clip, Timeline } from "../core/types.d.ts" */

/**
 * The thumbnails, as many as fit side by side, each at its own moment.
 *
 * @param {Clip} clip
 * @param {Timeline} timeline
 * @param {number} width
 * @param {number} height
 */
export function filmstrip(clip, { thumbnails }, width, height) {
  if (!thumbnails || !width) return null;
  const each = height * (clip.width / clip.height);
  const count = Math.max(1, Math.ceil(width / each));
  const source = `url(${api.clips.filmstrip(clip)})`;
  return h(
    "div",
    { className: "filmstrip", "aria-hidden": "true" },
    Array.from({ length: count }, (_, place) => {
      const index = Math.min(
        thumbnails - 1,
        Math.round((((place + 0.5) * each) / width) * (thumbnails - 1)),
      );
      return h("i", {
        style: {
          left: `${(100 * place * each) / width}%`,
          width: `${(100 * each) / width}%`,
          "background-image": source,
          "background-size": `${thumbnails * 100}% 100%`,
          "background-position": `${thumbnails > 1 ? (100 * index) / (thumbnails - 1) : 0}% 0`,
        },
      });
    }),
  );
}
