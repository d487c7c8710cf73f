// The form of a gesture: its texts, and its switches.

import { h } from "../core/dom.js";
import { limit } from "../core/text-limit.js";
import { read } from "../languages/robot-command.js";
import { change, draft, rest } from "./gesture-draft.js";

/** @import { Outlook, SwitchName } from "../core/types.d.ts" */

/** @import { Draft } from "./gesture-draft.js" */

/** @typedef {{ name: SwitchName, title: string, words: Record<Draft[SwitchName], string> }} Switch */

/** @typedef {{ input: HTMLInputElement | HTMLTextAreaElement, note: HTMLElement }} Field */

const MOST = { label: 80, description: 2000, command: 4000 };

/** @type {Draft[SwitchName][]} */
const POSITIONS = ["auto", "on", "off"];

/** @type {Switch[]} */
const SWITCHES = [
  {
    name: "direction",
    title: "Direction",
    words: {
      auto: "Used where the language needs it",
      on: "Only in the demonstrated direction",
      off: "In either direction",
    },
  },
  {
    name: "tempo",
    title: "Tempo",
    words: {
      auto: "Used where the language needs it",
      on: "Only at the demonstrated duration",
      off: "At any speed",
    },
  },
  {
    name: "mirror",
    title: "Mirror",
    words: {
      auto: "Movements only by the demonstrated hand, held shapes by either",
      on: "Also mirrored, by the other hand",
      off: "Never mirrored, and sides are never exchanged",
    },
  },
  {
    name: "hand_shape",
    title: "Hand shape",
    words: {
      auto: "Used where several demonstrations agree on it",
      on: "Only with the demonstrated hand shape",
      off: "With any hand shape",
    },
  },
];

/**
 * @param {keyof typeof MOST} name
 * @param {string} label
 * @param {HTMLInputElement | HTMLTextAreaElement} input
 * @param {string} [hint]
 */
function field(name, label, input, hint = "") {
  const note = h("p", { className: "dim", id: `editor-${name}-note` }, hint);
  input.id = `editor-${name}`;
  limit(input, MOST[name]);
  input.setAttribute("aria-describedby", note.id);
  input.oninput = () => change({ [name]: input.value }, name);
  input.onblur = rest;
  return {
    input,
    note,
    row: h("div", { className: "field" }, h("label", { for: input.id }, label), input, note),
  };
}

/**
 * Build the text fields; `draw` writes the draft into them and shows what is invalid.
 *
 * @param {() => string[]} taken
 */
export function texts(taken) {
  const label = field(
    "label",
    "Label",
    h("input", { type: "text", autocomplete: "off", required: true }),
  );
  const description = field(
    "description",
    "Description",
    h("textarea", { rows: 2 }),
    "What it looks like or means, for people.",
  );
  const command = field("command", "Command", h("textarea", { rows: 3, spellcheck: false }));
  const fields = { label, description, command };

  /**
   * @param {Field} field
   * @param {string | null | undefined} problem
   * @param {string} text
   */
  function annotate({ input, note }, problem, text) {
    note.textContent = problem ?? text;
    note.className = problem ? "field-problem" : "dim";
    input.setAttribute("aria-invalid", String(Boolean(problem)));
  }

  function draw() {
    const values = draft();
    for (const name of /** @type {const} */ (["label", "description", "command"]))
      if (fields[name].input.value !== values[name]) fields[name].input.value = values[name];
    annotate(
      label,
      labelProblem(values.label, taken()),
      "The name that the recogniser returns: circle, ascend, follow me.",
    );
    const { problem, kind } = read(values.command);
    annotate(command, problem, `For the robot, in words or as a JSON object; now: ${kind}.`);
  }
  return {
    element: h(
      "section",
      { className: "panel words", "aria-label": "Texts" },
      h("h2", {}, "Texts"),
      label.row,
      description.row,
      command.row,
    ),
    draw,
    // A proposed label is replaced by typing.
    focus: () => {
      label.input.focus({ preventScroll: true });
      label.input.select();
    },
  };
}

/**
 * @param {string} label
 * @param {string[]} taken
 */
function labelProblem(label, taken) {
  const trimmed = label.trim();
  if (!trimmed) return "Label is empty; type one.";
  if (!/[\p{L}\p{N}\p{S}]/u.test(trimmed)) return "Write the label in letters or digits.";
  if (/[<>]/.test(trimmed)) return "Leave out < and >.";
  return taken.includes(trimmed)
    ? `There is a gesture \u201c${trimmed}\u201d already; choose another label.`
    : null;
}

/**
 * The first invalid text and its field; null when all are valid.
 *
 * @param {Draft} values
 * @param {string[]} taken
 */
export function textProblem(values, taken) {
  const label = labelProblem(values.label, taken);
  if (label) return { id: "editor-label", text: label };
  const { problem } = read(values.command);
  return problem ? { id: "editor-command", text: problem } : null;
}

/** @param {Switch} choice */
function choice({ name, title, words }) {
  const id = `switch-${name}`;
  const inputs = POSITIONS.map((position) =>
    h("input", {
      type: "radio",
      name: id,
      value: position,
      id: `${id}-${position}`,
      onchange: () => change({ [name]: position }),
    }),
  );
  const options = POSITIONS.flatMap((position, index) => [
    inputs[index],
    h(
      "label",
      { for: inputs[index].id, title: words[position] },
      position[0].toUpperCase() + position.slice(1),
    ),
  ]);
  const meaning = h("p", { className: "dim" });
  const outcome = h("p", { className: "comes-to" });
  const element = h(
    "fieldset",
    { className: "switch" },
    h("legend", {}, title),
    h("div", { className: "segments" }, options),
    meaning,
    outcome,
  );
  /** @param {Outlook | null} found */
  function draw(found) {
    const position = draft()[name];
    for (const input of inputs) input.checked = input.value === position;
    meaning.textContent = `${words[position]}.`;
    const settled = found?.switches[name];
    outcome.hidden = !settled || settled.position !== position || position !== "auto";
    outcome.textContent = settled ? `Here: ${settled.words}.` : "";
  }
  return { element, draw };
}

/** Build the switches; `draw(estimate)` also shows what the automatic ones resolve to. */
export function switches() {
  const choices = SWITCHES.map(choice);
  return {
    element: h(
      "section",
      { className: "panel switches", "aria-label": "Switches" },
      h("h2", {}, "Switches"),
      choices.map((each) => each.element),
    ),
    /** @param {Outlook | null} found */
    draw: (found) => choices.forEach((each) => each.draw(found)),
  };
}
