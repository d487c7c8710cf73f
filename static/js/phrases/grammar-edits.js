// Edits of a grammar, as functions of it: each can be applied again to a newer revision.

/** @import { GesturesPart, Grammar, GroupPart, Phrase, PhrasePart, SlotPart, SlotType } from "../core/types.d.ts" */

/** @typedef {"start" | "end" | "cancel"} Role */

/** @type {Role[]} */
export const ROLES = ["start", "end", "cancel"];

/**
 * A name that is not in `taken`: `stem`, or `stem` with a number.
 *
 * @param {string} stem
 * @param {string[]} taken
 * @param {string} [joint]
 */
export function free(stem, taken, joint = " ") {
  if (!taken.includes(stem)) return stem;
  let number = 2;
  while (taken.includes(`${stem}${joint}${number}`)) number += 1;
  return `${stem}${joint}${number}`;
}

/**
 * @template T
 * @param {T[]} list
 * @param {number} index
 * @param {(each: T) => T} change
 */
const at = (list, index, change) =>
  list.map((each, place) => (place === index ? change(each) : each));

/**
 * @template T
 * @param {T[]} list
 * @param {number} index
 */
export const without = (list, index) => list.filter((_, place) => place !== index);

/**
 * Exchange an entry with its neighbour.
 *
 * @template T
 * @param {T[]} list
 * @param {number} index
 * @param {number} by
 */
export function moved(list, index, by) {
  const next = [...list];
  [next[index], next[index + by]] = [next[index + by], next[index]];
  return next;
}

/** @type {Map<string, string>} */
const renamed = new Map();

/**
 * Remember a new name: a button pressed before the form shows it must still find its entry.
 *
 * @param {string} before
 * @param {string} after
 */
export const rememberName = (before, after) => renamed.set(before, after);

/**
 * The present name of an entry, which may have been renamed.
 *
 * @param {{ name: string }[]} list
 * @param {string} name
 */
export function called(list, name) {
  let now = name;
  for (
    let next = renamed.get(now);
    next !== undefined && !list.some((each) => each.name === now);
    next = renamed.get(now)
  )
    now = next;
  return now;
}

/**
 * Change the entry of that name.
 *
 * @template {{ name: string }} T
 * @param {T[]} list
 * @param {string} name
 * @param {(entry: T) => T} change
 */
function inEntry(list, name, change) {
  const now = called(list, name);
  return list.map((each) => (each.name === now ? change(each) : each));
}

/** @type {(name: string, change: (phrase: Phrase) => Phrase) => (whole: Grammar) => Grammar} */
export const inPhrase = (name, change) => (whole) => ({
  ...whole,
  phrases: inEntry(whole.phrases, name, change),
});

/** @type {(name: string, change: (type: SlotType) => SlotType) => (whole: Grammar) => Grammar} */
export const inSlotType = (name, change) => (whole) => ({
  ...whole,
  slot_types: inEntry(whole.slot_types, name, change),
});

/**
 * Change the list of parts at `path`: [] is the phrase's own list, [2] that of the group in third
 * place.
 *
 * @param {number[]} path
 * @param {(parts: PhrasePart[]) => PhrasePart[]} change
 * @returns {<T extends Phrase | GroupPart>(whole: T) => T}
 */
export const inParts = (path, change) => (whole) =>
  path.length
    ? {
        ...whole,
        parts: at(/** @type {PhrasePart[]} */ (whole.parts), path[0], (part) =>
          "parts" in part ? inParts(path.slice(1), change)(part) : part,
        ),
      }
    : { ...whole, parts: change(whole.parts) };

/**
 * Change one part.
 *
 * @param {number[]} path
 * @param {(part: PhrasePart) => PhrasePart} change
 */
export const inPart = (path, change) =>
  inParts(path.slice(0, -1), (parts) => at(parts, path.at(-1) ?? 0, change));

/** @type {(parts: PhrasePart[]) => PhrasePart[]} */
export const everyPart = (parts) =>
  parts.flatMap((part) => ("parts" in part ? [part, ...everyPart(part.parts)] : [part]));

/** @param {Phrase} phrase */
export const slotsOf = (phrase) => everyPart(phrase.parts).filter((part) => "slot" in part);

/**
 * Change every slot, also those in groups.
 *
 * @param {PhrasePart[]} parts
 * @param {(slot: SlotPart) => SlotPart} change
 * @returns {PhrasePart[]}
 */
function withSlots(parts, change) {
  /** @param {GesturesPart | SlotPart} part */
  const one = (part) => ("slot" in part ? change(part) : part);
  return parts.map((part) =>
    "parts" in part ? { ...part, parts: part.parts.map(one) } : one(part),
  );
}

/** @param {Grammar} whole */
const framing = (whole) => ROLES.map((role) => whole[role]);

/**
 * The gesture proposed for a new entry: one that is not used yet, if there is one.
 *
 * @param {Grammar} whole
 * @param {string[]} labels
 */
function unusedGesture(whole, labels) {
  const used = new Set([
    ...framing(whole),
    ...whole.phrases.flatMap(({ parts }) =>
      everyPart(parts).flatMap((part) => ("gestures" in part ? part.gestures : [])),
    ),
    ...whole.slot_types.flatMap(({ values }) => values.map(({ gesture }) => gesture)),
  ]);
  return (
    labels.find((label) => !used.has(label)) ??
    labels.find((label) => label !== whole.cancel) ??
    labels[0]
  );
}

/**
 * @param {Grammar} whole
 * @param {string[]} labels
 * @returns {GesturesPart}
 */
export const gesturePart = (whole, labels) => ({
  gestures: [unusedGesture(whole, labels)],
  least: 1,
  most: 1,
});

/**
 * @param {Grammar} whole
 * @param {string} name
 * @param {string[]} labels
 * @returns {Grammar}
 */
export function withPhrase(whole, name, labels) {
  return {
    ...whole,
    phrases: [
      ...whole.phrases,
      { name, parts: [gesturePart(whole, labels)], command: null, says: "" },
    ],
  };
}

/**
 * @param {Grammar} whole
 * @param {string[]} labels
 * @returns {Grammar}
 */
export function withSlotType(whole, labels) {
  const name = free(
    "number",
    whole.slot_types.map((each) => each.name),
  );
  return {
    ...whole,
    slot_types: [
      ...whole.slot_types,
      { name, reads_as: "number", values: [{ gesture: unusedGesture(whole, labels), value: 1 }] },
    ],
  };
}

/**
 * Add a slot to the parts at `path` of a phrase, and a slot type if there is none yet.
 *
 * @param {Grammar} whole
 * @param {string} phraseName
 * @param {number[]} path
 * @param {string[]} labels
 */
export function withSlot(whole, phraseName, path, labels) {
  const ready = whole.slot_types.length ? whole : withSlotType(whole, labels);
  const type = ready.slot_types[0].name;
  const slug =
    type
      .toLowerCase()
      .replace(/[^a-z0-9_]+/g, "_")
      .replace(/^[^a-z]+/, "") || "value";
  return inPhrase(phraseName, (phrase) => {
    const slot = {
      slot: free(
        slug.slice(0, 36),
        slotsOf(phrase).map((each) => each.slot),
        "_",
      ),
      type,
      least: 1,
      most: 1,
      default: null,
    };
    return inParts(path, (parts) => [...parts, slot])(phrase);
  })(ready);
}

/**
 * Rename a slot, also where the phrase's texts refer to it.
 *
 * @param {Phrase} phrase
 * @param {string} before
 * @param {string} after
 * @returns {Phrase}
 */
export function withSlotRenamed(phrase, before, after) {
  /** @param {string} text */
  const inText = (text) => text.replaceAll(`{${before}}`, `{${after}}`);
  /** @type {(value: unknown) => unknown} */
  const inValue = (value) => {
    if (typeof value === "string") return inText(value);
    if (Array.isArray(value)) return value.map(inValue);
    return value && typeof value === "object" ? inObject(value) : value;
  };
  /** @param {object} value */
  const inObject = (value) =>
    Object.fromEntries(Object.entries(value).map(([key, each]) => [key, inValue(each)]));
  const { command, says } = phrase;
  return {
    ...phrase,
    parts: withSlots(phrase.parts, (slot) =>
      slot.slot === before ? { ...slot, slot: after } : slot,
    ),
    says: inText(says),
    command: typeof command === "string" ? inText(command) : command ? inObject(command) : command,
  };
}

/**
 * Rename a slot type, also where slots refer to it.
 *
 * @param {Grammar} whole
 * @param {string} before
 * @param {string} after
 * @returns {Grammar}
 */
export function withSlotTypeRenamed(whole, before, after) {
  return {
    ...whole,
    slot_types: whole.slot_types.map((each) =>
      each.name === before ? { ...each, name: after } : each,
    ),
    phrases: whole.phrases.map((phrase) => ({
      ...phrase,
      parts: withSlots(phrase.parts, (slot) =>
        slot.type === before ? { ...slot, type: after } : slot,
      ),
    })),
  };
}

/**
 * The value of a typed text: a number if the slot type reads numbers.
 *
 * @param {string} text
 * @param {SlotType["reads_as"]} [readsAs]
 */
export function typed(text, readsAs) {
  const trimmed = text.trim();
  if (readsAs === "text") return trimmed;
  const number = Number(trimmed.replace(",", "."));
  return trimmed && Number.isFinite(number) ? number : trimmed;
}
