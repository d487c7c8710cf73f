// The label that a clip's file name suggests.

import { withoutJoiners } from "../core/joiners.js";

/**
 * The words and numbers of a name, with a space around each.
 *
 * @param {string} name
 */
const words = (name) =>
  ` ${(
    withoutJoiners(name)
      .toLowerCase()
      .match(/\p{L}+|\p{N}+/gu) ?? []
  ).join(" ")} `;

/**
 * Find the label that a clip's name contains, or "". "circle-2.mp4" probably shows a circle and
 * "unfinished triangle" a triangle; the label that stands first wins, then the longer one.
 *
 * @param {string} clipName
 * @param {string[]} labels
 */
export function labelInName(clipName, labels) {
  const name = words(clipName);
  const named = labels
    .map((label) => ({ label, at: words(label).trim() ? name.indexOf(words(label)) : -1 }))
    .filter(({ at }) => at >= 0);
  named.sort((one, other) => one.at - other.at || other.label.length - one.label.length);
  return named[0]?.label ?? "";
}
