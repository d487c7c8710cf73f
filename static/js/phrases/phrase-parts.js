// The form of a phrase's parts: gestures, slots, and groups of both.

import { asOptions, html, nothing } from "../templates.js";
import { addButton, checkbox, choice, textField, tool } from "./form-fields.js";
import {
  gesturePart,
  inPart,
  inParts,
  inPhrase,
  moved,
  typed,
  without,
  withSlot,
  withSlotRenamed,
} from "./grammar-edits.js";
import { grammar, labels, save } from "./grammar-store.js";

/** @import { GesturesPart, Grammar, GroupPart, Phrase, PhrasePart, SlotPart } from "../core/types.d.ts" */

/** @type {[string, string]} */
const TAKE_OUT = ["", "take out"];

/** @param {number[]} path */
const idOf = (path) => `part-${path.join("-")}`;

/**
 * Change one part of a phrase.
 *
 * @param {Phrase} phrase
 * @param {number[]} path
 * @param {string} title
 * @param {Partial<GesturesPart> | Partial<SlotPart>} change
 */
const put = (phrase, path, title, change) =>
  save(
    title,
    inPhrase(
      phrase.name,
      inPart(path, (part) => Object.assign({ ...part }, change)),
    ),
  );

/**
 * @param {Phrase} phrase
 * @param {number[]} path
 * @param {GesturesPart} part
 */
function gestures(phrase, path, part) {
  const { cancel } = grammar();
  const several = part.gestures.length > 1;
  const free = labels().filter((label) => label !== cancel && !part.gestures.includes(label));
  /**
   * @param {string[]} list
   * @param {string} title
   */
  const pick = (list, title) => put(phrase, path, title, { gestures: list });
  const chosen = part.gestures.map((label, index) => [
    index ? html`<span class="dim">or</span>` : nothing,
    choice({
      id: `${idOf(path)}-gesture-${index}`,
      label: index ? `Or gesture ${index + 1}` : "Gesture",
      hidden: true,
      value: label,
      options: [...asOptions([label, ...free]), ...(several ? [TAKE_OUT] : [])],
      commit: (value) =>
        pick(
          value
            ? part.gestures.map((each) => (each === label ? value : each))
            : part.gestures.filter((each) => each !== label),
          value || `Not ${label}`,
        ),
    }),
  ]);
  const more = () =>
    choice({
      id: `${idOf(path)}-or`,
      label: "Or another gesture",
      hidden: true,
      value: "",
      options: [["", "or\u2026"], ...asOptions(free)],
      commit: (value) => pick([...part.gestures, value], `Or ${value}`),
    });
  return html`<div class="part-what">
    <b>Gesture</b>${chosen}${free.length ? html`<span class="part-or">${more()}</span>` : nothing}
  </div>`;
}

/**
 * @param {Phrase} phrase
 * @param {number[]} path
 * @param {SlotPart} part
 */
function slot(phrase, path, part) {
  const types = grammar().slot_types;
  const readsAs = types.find(({ name }) => name === part.type)?.reads_as;
  const id = idOf(path);
  return html`<div class="part-what">
    <b>Slot</b>${textField({
      id: `${id}-slot`,
      label: "Name of the slot",
      hidden: true,
      value: part.slot,
      commit: (text) =>
        save(
          `Rename to ${text}`,
          inPhrase(phrase.name, (whole) => withSlotRenamed(whole, part.slot, text.trim())),
        ),
    })}${choice({
      id: `${id}-type`,
      label: "filled by",
      value: part.type,
      options: asOptions(types.map(({ name }) => name)),
      commit: (type) => put(phrase, path, `Filled by ${type}`, { type, default: null }),
    })}${
      part.least === 0
        ? textField({
            id: `${id}-default`,
            label: "otherwise",
            value: String(part.default ?? ""),
            placeholder: "nothing",
            commit: (text) =>
              put(phrase, path, `Otherwise ${text || "nothing"}`, {
                default: text.trim() ? typed(text, readsAs) : null,
              }),
          })
        : nothing
    }
  </div>`;
}

/**
 * @param {Phrase} phrase
 * @param {number[]} path
 * @param {GroupPart} part
 */
const group = (phrase, path, part) =>
  html`<div class="part-group">
    <b>Together</b>${partList(phrase, path, part.parts)}${addButtons(phrase, path)}
  </div>`;

/** @param {PhrasePart} part */
const nounOf = (part) => ("parts" in part ? "group" : "slot" in part ? "slot" : "gesture");

/**
 * The fields of a part of any kind.
 *
 * @param {Phrase} phrase
 * @param {number[]} path
 * @param {PhrasePart} part
 * @returns {unknown}
 */
function whatOf(phrase, path, part) {
  if ("parts" in part) return group(phrase, path, part);
  return "slot" in part ? slot(phrase, path, part) : gestures(phrase, path, part);
}

/**
 * @param {Phrase} phrase
 * @param {number[]} path
 * @param {PhrasePart} part
 * @param {number} count
 */
function partRow(phrase, path, part, count) {
  const noun = nounOf(part);
  const [list, index] = [path.slice(0, -1), path.at(-1) ?? 0];
  const id = idOf(path);
  const what = `${noun} ${path.map((place) => place + 1).join(".")}`;
  /**
   * @param {string} title
   * @param {(parts: PhrasePart[]) => PhrasePart[]} change
   */
  const rearrange = (title, change) => save(title, inPhrase(phrase.name, inParts(list, change)));
  /** @param {string} text */
  const times = (text) => {
    const most = Number(text);
    return put(phrase, path, `Up to ${text} times`, { most, least: Math.min(part.least, most) });
  };
  return html`<li class="part ${part.least === 0 ? "optional" : ""}">
    ${whatOf(phrase, path, part)}
    <div class="part-often">
      ${checkbox({
        id: `${id}-optional`,
        label: "may be left out",
        checked: part.least === 0,
        commit: (on) =>
          put(phrase, path, on ? "May be left out" : "Must be shown", {
            least: on ? 0 : 1,
            ...("slot" in part ? { default: null } : {}),
          }),
      })}${textField({
        id: `${id}-most`,
        label: "up to",
        value: String(part.most),
        number: { min: 1, max: 10, step: 1 },
        commit: times,
      })}<span class="dim"
        >${part.least > 1 ? `times, at least ${part.least}` : part.most > 1 ? "times" : "time"}</span
      >
    </div>
    <div class="part-tools">
      ${tool(
        `${id}-up`,
        "up",
        `Move ${what} up`,
        () => rearrange("Move up", (parts) => moved(parts, index, -1)),
        index === 0,
      )}${tool(
        `${id}-down`,
        "down",
        `Move ${what} down`,
        () => rearrange("Move down", (parts) => moved(parts, index, 1)),
        index === count - 1,
      )}${tool(
        `${id}-remove`,
        "trash",
        `Delete ${what}`,
        () => rearrange(`Deletion of a ${noun}`, (parts) => without(parts, index)),
        count === 1,
      )}
    </div>
  </li>`;
}

/**
 * Draw the parts at `path`.
 *
 * @param {Phrase} phrase
 * @param {number[]} path
 * @param {PhrasePart[]} parts
 */
export const partList = (phrase, path, parts) =>
  html`<ol
    class="parts"
    aria-label=${path.length ? "Parts of the group" : `Parts of ${phrase.name}`}
  >
    ${parts.map((part, index) => partRow(phrase, [...path, index], part, parts.length))}
  </ol>`;

/**
 * Draw the buttons that add a part at `path`; a group holds no groups.
 *
 * @param {Phrase} phrase
 * @param {number[]} [path]
 */
export function addButtons(phrase, path = []) {
  const id = `add-${path.join("-")}`;
  /**
   * @param {string} title
   * @param {(base: Grammar) => PhrasePart} make
   */
  const add = (title, make) =>
    save(title, (base) =>
      inPhrase(
        phrase.name,
        inParts(path, (parts) => [...parts, make(base)]),
      )(base),
    );
  const part = () => add("New gesture in a phrase", (base) => gesturePart(base, labels()));
  const slotted = () => save("New slot", (base) => withSlot(base, phrase.name, path, labels()));
  const grouped = () =>
    add("New group", (base) => ({ parts: [gesturePart(base, labels())], least: 0, most: 1 }));
  return html`<div class="part-add">
    ${addButton(`${id}-gesture`, "Gesture", part)}${addButton(`${id}-slot`, "Slot", slotted)}${
      path.length ? nothing : addButton(`${id}-group`, "Group", grouped)
    }
  </div>`;
}
