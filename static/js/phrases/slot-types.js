// The panel of slot types: gestures, each with the value it stands for.

import { asOptions, buttonOf, html, nothing } from "../templates.js";
import { addButton, choice, textField, tool } from "./form-fields.js";
import {
  inSlotType,
  rememberName,
  slotsOf,
  typed,
  without,
  withSlotType,
  withSlotTypeRenamed,
} from "./grammar-edits.js";
import { grammar, labels, save } from "./grammar-store.js";

/** @import { SlotType, SlotValue } from "../core/types.d.ts" */

/** @type {[SlotType["reads_as"], string][]} */
const READS = [
  ["number", "a number each"],
  ["text", "a word each"],
  ["digits", "digits of one number"],
];

/**
 * @param {string} name
 * @param {(values: SlotValue[]) => SlotValue[]} change
 */
const inValues = (name, change) =>
  inSlotType(name, (each) => ({ ...each, values: change(each.values) }));

/**
 * Convert values when the slot type reads its gestures as another kind.
 *
 * @param {SlotValue[]} values
 * @param {SlotType["reads_as"]} readsAs
 */
const converted = (values, readsAs) =>
  values.map(({ gesture, value }, index) => {
    if (readsAs === "text") return { gesture, value: String(value) };
    const number = Number(value);
    const fits =
      Number.isFinite(number) &&
      (readsAs === "number" || (Number.isInteger(number) && number >= 0 && number <= 9));
    return { gesture, value: fits ? number : index % 10 };
  });

/**
 * @param {SlotType} type
 * @param {number} place
 * @param {SlotValue} value
 * @param {number} index
 */
function valueRow(type, place, { gesture, value }, index) {
  const id = `slot-type-${place}-value-${index}`;
  const taken = type.values.map((each) => each.gesture);
  const options = asOptions(
    labels().filter((label) => label === gesture || !taken.includes(label)),
  );
  /** @param {Partial<SlotValue>} change */
  const put = (change) =>
    inValues(type.name, (values) =>
      values.map((each, at) => (at === index ? { ...each, ...change } : each)),
    );
  return html`<li>
    ${choice({
      id: `${id}-gesture`,
      label: `Gesture ${index + 1} of ${type.name}`,
      hidden: true,
      value: gesture,
      options,
      commit: (label) => save(`${type.name}: ${label}`, put({ gesture: label })),
    })}<span class="dim" aria-hidden="true">=</span>${textField({
      id,
      label: `Value of ${gesture}`,
      hidden: true,
      value: String(value),
      commit: (text) =>
        save(`${gesture} means ${text}`, put({ value: typed(text, type.reads_as) })),
    })}${tool(
      `${id}-remove`,
      "close",
      `Take ${gesture} out of ${type.name}`,
      () =>
        save(
          `${gesture} out of ${type.name}`,
          inValues(type.name, (values) => without(values, index)),
        ),
      type.values.length === 1,
    )}
  </li>`;
}

/** @param {SlotType} type */
function addValue(type) {
  const left = labels().filter((label) => !type.values.some(({ gesture }) => gesture === label));
  const next =
    type.reads_as === "text"
      ? null
      : Math.max(...type.values.map(({ value }) => Number(value))) + 1;
  return save(
    `${type.name}: ${left[0]}`,
    inValues(type.name, (values) => [
      ...values,
      {
        gesture: left[0],
        value: next === null ? left[0] : type.reads_as === "digits" ? next % 10 : next,
      },
    ]),
  );
}

/**
 * @param {SlotType} type
 * @param {string} name
 */
async function rename(type, name) {
  const kept = await save(`Rename to ${name}`, (base) =>
    withSlotTypeRenamed(base, type.name, name),
  );
  if (kept) rememberName(type.name, name);
  return kept;
}

/**
 * @param {SlotType} type
 * @param {number} place
 */
function slotType(type, place) {
  const id = `slot-type-${place}`;
  const users = grammar()
    .phrases.filter((phrase) => slotsOf(phrase).some((slot) => slot.type === type.name))
    .map(({ name }) => name);
  const remove = tool(
    `${id}-remove`,
    "trash",
    users.length ? `${type.name} is used by ${users.join(", ")}` : `Delete ${type.name}`,
    () =>
      save(`Deletion of ${type.name}`, (base) => ({
        ...base,
        slot_types: base.slot_types.filter((each) => each.name !== type.name),
      })),
    users.length > 0,
  );
  return html`<li class="slot-type">
    <div class="slot-type-head">
      ${textField({
        id: `${id}-name`,
        label: "Name of the values",
        hidden: true,
        value: type.name,
        commit: (text) => rename(type, text.trim()),
      })}${choice({
        id: `${id}-reads`,
        label: `How ${type.name} is read`,
        hidden: true,
        value: type.reads_as,
        options: READS,
        commit: (readsAs) =>
          save(
            `${type.name} reads ${readsAs}`,
            inSlotType(type.name, (each) => ({
              ...each,
              reads_as: readsAs,
              values: converted(each.values, readsAs),
            })),
          ),
      })}${remove}
    </div>
    <ul class="slot-values" aria-label="Gestures of ${type.name}">
      ${type.values.map((value, index) => valueRow(type, place, value, index))}
    </ul>
    ${buttonOf("Add a gesture", () => addValue(type), {
      look: "link",
      writes: true,
      id: `${id}-add`,
      hidden: type.values.length === labels().length,
    })}
  </li>`;
}

/** Draw the panel. */
export function slotTypesPanel() {
  const { slot_types: types } = grammar();
  const add = () => save("New values", (base) => withSlotType(base, labels()));
  return html`<section class="panel" aria-labelledby="slot-types-title">
    <h2 id="slot-types-title">Values</h2>
    <p class="dim">
      Gestures that stand for a number or a word, to fill the slots of phrases: how often, how deep,
      which way.
    </p>
    ${
      types.length
        ? html`<ul class="slot-types">
            ${types.map(slotType)}
          </ul>`
        : nothing
    }
    <div>${addButton("add-slot-type", "Add values", add)}</div>
  </section>`;
}
