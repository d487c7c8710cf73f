// What a gesture says, and which of its properties count.

import { h } from "../core/dom.js";
import { read } from "../languages/robot-command.js";
import { change, draft, rest } from "./gesture-draft.js";

const MOST = { label: 80, description: 2000, command: 4000 };

const SWITCHES = [
  {
    name: "direction",
    title: "Direction",
    words: {
      auto: "Counts where the language needs it",
      on: "Only the way round it is shown",
      off: "Either way round",
    },
  },
  {
    name: "tempo",
    title: "Tempo",
    words: {
      auto: "Counts where the language needs it",
      on: "How long it takes counts",
      off: "However fast it is shown",
    },
  },
  {
    name: "mirror",
    title: "Mirror",
    words: {
      auto: "The hand that shows it counts",
      on: "The other hand, mirrored, means it too",
      off: "Never, and sides are never exchanged",
    },
  },
];

function field(name, label, input, hint = "") {
  const note = h("p", { className: "dim", id: `editor-${name}-note` }, hint);
  input.id = `editor-${name}`;
  input.maxLength = MOST[name];
  input.setAttribute("aria-describedby", note.id);
  input.oninput = () => change({ [name]: input.value }, name);
  input.onblur = rest;
  return {
    input,
    note,
    row: h("div", { className: "field" }, h("label", { for: input.id }, label), input, note),
  };
}

/** Build the text fields; `draw` puts the draft into them and says what is wrong with it. */
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

  function tell({ input, note }, problem, text) {
    note.textContent = problem ?? text;
    note.className = problem ? "field-problem" : "dim";
    input.setAttribute("aria-invalid", String(Boolean(problem)));
  }

  function draw() {
    const values = draft();
    for (const [name, { input }] of Object.entries(fields))
      if (input.value !== values[name]) input.value = values[name];
    tell(
      label,
      labelProblem(values.label, taken()),
      "What the recogniser answers: circle, ascend, follow me.",
    );
    const { problem, kind } = read(values.command);
    tell(command, problem, `${kind}. Words, or a JSON object for the robot.`);
  }
  return {
    element: h(
      "section",
      { className: "panel words", "aria-label": "What it says" },
      h("h2", {}, "What it says"),
      label.row,
      description.row,
      command.row,
    ),
    draw,
    focus: () => label.input.focus({ preventScroll: true }),
  };
}

function labelProblem(label, taken) {
  const trimmed = label.trim();
  return taken.includes(trimmed)
    ? `There is a gesture \u201c${trimmed}\u201d already; choose another label.`
    : null;
}

/** What is wrong with the texts, and the field to mend; null when nothing is. */
export function textProblem(values, taken) {
  if (!values.label.trim()) return { id: "editor-label", text: "Label is empty; type one." };
  const label = labelProblem(values.label, taken);
  if (label) return { id: "editor-label", text: label };
  const { problem } = read(values.command);
  return problem ? { id: "editor-command", text: problem } : null;
}

function choice({ name, title, words }) {
  const id = `switch-${name}`;
  const inputs = ["auto", "on", "off"].map((position) =>
    h("input", {
      type: "radio",
      name: id,
      value: position,
      id: `${id}-${position}`,
      onchange: () => change({ [name]: position }),
    }),
  );
  const options = inputs.flatMap((input) => [
    input,
    h(
      "label",
      { for: input.id, title: words[input.value] },
      input.value[0].toUpperCase() + input.value.slice(1),
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

/** Build the switches; `draw(outlook)` also says what the automatic ones come to. */
export function switches() {
  const choices = SWITCHES.map(choice);
  return {
    element: h(
      "section",
      { className: "panel switches", "aria-label": "What of it counts" },
      h("h2", {}, "What of it counts"),
      choices.map((each) => each.element),
    ),
    draw: (found) => choices.forEach((each) => each.draw(found)),
  };
}
