// Edits of a grammar, as functions of it: each can be applied again to a newer revision.

export const ROLES = ["start", "end", "cancel"];

/** A name that none of `taken` is: `stem`, or `stem` with a number. */
export function free(stem, taken, joint = " ") {
  if (!taken.includes(stem)) return stem;
  let number = 2;
  while (taken.includes(`${stem}${joint}${number}`)) number += 1;
  return `${stem}${joint}${number}`;
}

const at = (list, index, change) =>
  list.map((each, place) => (place === index ? change(each) : each));
export const without = (list, index) => list.filter((_, place) => place !== index);

/** Exchange an entry with its neighbour. */
export function moved(list, index, by) {
  const next = [...list];
  [next[index], next[index + by]] = [next[index + by], next[index]];
  return next;
}

const renamed = new Map();

/** Remember a new name: what was pressed before the form showed it still means the same entry. */
export const rememberName = (before, after) => renamed.set(before, after);

/** The name of the entry that has that name, or was given another one since. */
export function called(list, name) {
  let now = name;
  while (!list.some((each) => each.name === now) && renamed.has(now)) now = renamed.get(now);
  return now;
}

const inEntry = (key) => (name, change) => (whole) => {
  const now = called(whole[key], name);
  return { ...whole, [key]: whole[key].map((each) => (each.name === now ? change(each) : each)) };
};

export const inPhrase = inEntry("phrases");
export const inSlotType = inEntry("slot_types");

/**
 * Change the list of parts that `path` leads to: [] the phrase's own, [2] that of the group in
 * third place.
 */
export const inParts = (path, change) => (phrase) =>
  path.length
    ? { ...phrase, parts: at(phrase.parts, path[0], inParts(path.slice(1), change)) }
    : { ...phrase, parts: change(phrase.parts) };

export const inPart = (path, change) =>
  inParts(path.slice(0, -1), (parts) => at(parts, path.at(-1), change));

export const everyPart = (parts) =>
  parts.flatMap((part) => (part.parts ? [part, ...everyPart(part.parts)] : [part]));
export const slotsOf = (phrase) => everyPart(phrase.parts).filter((part) => part.slot);

const framing = (whole) => ROLES.map((role) => whole[role]);

/** The gesture to begin with: one that nothing uses yet, if there is one. */
function unusedGesture(whole, labels) {
  const used = new Set([
    ...framing(whole),
    ...whole.phrases.flatMap(({ parts }) =>
      everyPart(parts).flatMap((part) => part.gestures ?? []),
    ),
    ...whole.slot_types.flatMap(({ values }) => values.map(({ gesture }) => gesture)),
  ]);
  return (
    labels.find((label) => !used.has(label)) ??
    labels.find((label) => label !== whole.cancel) ??
    labels[0]
  );
}

export const gesturePart = (whole, labels) => ({
  gestures: [unusedGesture(whole, labels)],
  least: 1,
  most: 1,
});

export function withPhrase(whole, name, labels) {
  return {
    ...whole,
    phrases: [
      ...whole.phrases,
      { name, parts: [gesturePart(whole, labels)], command: null, says: "" },
    ],
  };
}

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
 * Add a slot to the parts at `path` of a phrase, and something to fill it with where there is
 * nothing yet.
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

/** Rename a slot, also where the phrase's texts refer to it. */
export function withSlotRenamed(phrase, before, after) {
  const texts = (value) => {
    if (typeof value === "string") return value.replaceAll(`{${before}}`, `{${after}}`);
    if (Array.isArray(value)) return value.map(texts);
    if (value && typeof value === "object")
      return Object.fromEntries(Object.entries(value).map(([key, each]) => [key, texts(each)]));
    return value;
  };
  const part = (each) =>
    each.parts
      ? { ...each, parts: each.parts.map(part) }
      : each.slot === before
        ? { ...each, slot: after }
        : each;
  return {
    ...phrase,
    parts: phrase.parts.map(part),
    says: texts(phrase.says),
    command: texts(phrase.command),
  };
}

/** Rename a slot type, also where slots refer to it. */
export function withSlotTypeRenamed(whole, before, after) {
  const part = (each) =>
    each.parts
      ? { ...each, parts: each.parts.map(part) }
      : each.type === before
        ? { ...each, type: after }
        : each;
  return {
    ...whole,
    slot_types: whole.slot_types.map((each) =>
      each.name === before ? { ...each, name: after } : each,
    ),
    phrases: whole.phrases.map((phrase) => ({ ...phrase, parts: phrase.parts.map(part) })),
  };
}

/** A value as it was typed: a number where the slot type reads numbers. */
export function typed(text, readsAs) {
  const trimmed = text.trim();
  if (readsAs === "text") return trimmed;
  const number = Number(trimmed.replace(",", "."));
  return trimmed && Number.isFinite(number) ? number : trimmed;
}
