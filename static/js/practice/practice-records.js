// The records of practice: the evidence that each diver's takes give, and the takes themselves.

import { h, iconButton, WRITES } from "../core/dom.js";
import { askWhich, percent, plural } from "../core/format.js";
import { state } from "../core/state.js";
import { address, go, here } from "../core/views.js";

/** @import { PracticeRecord, PracticeTake } from "../core/types.d.ts" */

/** @typedef {(take: PracticeTake) => void} Remove */

/**
 * The evidence of a record in words, and what is missing.
 *
 * @param {Omit<PracticeRecord, "diver" | "older" | "pairs" | "shown">} record
 */
export function evidenceOf({ takes, errors, bound, limit: most, reached, more, confidence }) {
  const counted = `${plural(errors, "error")} in ${plural(takes, "take")}`;
  const sure = `${percent(confidence)} confidence`;
  return reached
    ? `${counted}: under ${percent(most)} errors, by ${sure} at most ${(100 * bound).toFixed(1)} %.`
    : `${counted}: ${plural(more, "more take")} without an error for under ${percent(most)} errors at ${sure}.`;
}

/** @param {PracticeTake} take */
const placeOf = ({ clip_id: clip, recognition_id: recognition }) => ({
  clip,
  recognition,
  take: null,
  start: null,
  end: null,
  frame: null,
});

/**
 * @param {PracticeTake} take
 * @param {Remove} remove
 */
function takeRow(take, remove) {
  const clip = state.clips.find(({ id }) => id === take.clip_id);
  const place = placeOf(take);
  return h(
    "li",
    { className: take.right ? "right" : take.pair ? "asked" : "wrong" },
    h("span", { "aria-hidden": "true" }, take.right ? "\u2713" : take.pair ? "?" : "\u2260"),
    h(
      "span",
      {},
      h("b", {}, take.expected),
      take.right
        ? " recognised"
        : take.pair
          ? ` asked back: ${askWhich(take.pair)}`
          : ` read as ${take.label ?? "nothing"}`,
      h(
        "small",
        { className: "dim" },
        ` revision ${take.revision}${take.added_by ? `, added by ${take.added_by}` : ""}`,
      ),
    ),
    clip
      ? h(
          "a",
          { href: address("studio", place), onclick: here(() => go("studio", place)) },
          clip.name,
        )
      : h("span", { className: "dim" }, "its clip was deleted"),
    iconButton("close", `Remove this take of ${take.expected}`, () => remove(take), WRITES),
  );
}

/**
 * @param {PracticeRecord} record
 * @param {Remove} remove
 */
export function recordCard(record, remove) {
  const needed = record.takes + record.more;
  return h(
    "section",
    { className: `practice-record${record.reached ? " reached" : ""}`, "aria-label": record.diver },
    h("h3", {}, record.diver, record.reached ? " \u2713" : ""),
    h("p", {}, evidenceOf(record)),
    h("progress", {
      "aria-label": `Takes of ${record.diver}`,
      max: Math.max(1, needed),
      value: record.takes,
    }),
    record.pairs
      ? h(
          "p",
          { className: "dim" },
          `${plural(record.pairs, "take")} asked back with the right gesture: neither right nor an error.`,
        )
      : null,
    record.older
      ? h(
          "p",
          { className: "dim" },
          `${plural(record.older, "take")} with older revisions of the language do not count.`,
        )
      : null,
    h(
      "details",
      {},
      h("summary", {}, plural(record.shown.length, "take")),
      h(
        "ul",
        { className: "practice-takes" },
        record.shown.map((take) => takeRow(take, remove)),
      ),
    ),
  );
}
