// The diff of a language that is not saved yet against the revision it began from.

/** @import { Gesture, Language } from "../core/types.d.ts" */

/**
 * Diff the gestures of two versions: `{ gesture, kind }` each, with the server's kinds.
 *
 * @param {Language} mine
 * @param {Language} from
 * @returns {{ gesture: Gesture, kind: string }[]}
 */
export function diffGestures(mine, from) {
  // A gesture that is renamed keeps its picture.
  const before = new Map(from.gestures.map((each) => [each.thumbnail, each]));
  const after = mine.gestures.map((gesture) => {
    const known = before.get(gesture.thumbnail);
    before.delete(gesture.thumbnail);
    return {
      gesture,
      kind: !known
        ? "added"
        : JSON.stringify(known) === JSON.stringify(gesture)
          ? "same"
          : "changed",
    };
  });
  return [...after, ...[...before.values()].map((gesture) => ({ gesture, kind: "removed" }))];
}

/** @type {string[]} */
const TEXTS = ["name", "author", "label", "description", "command"];

/**
 * List the texts that differ, as lines to read.
 *
 * @param {Language} mine
 * @param {Language} from
 */
export function changedTexts(mine, from) {
  const before = new Map(from.gestures.map((each) => [each.thumbnail, each]));
  /** @type {[any, any][]} */
  const pairs = [
    [mine, from],
    ...mine.gestures.map(
      (each) => /** @type {[any, any]} */ ([each, before.get(each.thumbnail) ?? each]),
    ),
  ];
  return pairs.flatMap(([now, then]) =>
    TEXTS.filter((name) => now[name] !== then[name]).map(
      (name) => `${name}: \u201c${now[name] ?? ""}\u201d`,
    ),
  );
}
