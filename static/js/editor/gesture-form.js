// The form of a gesture: its texts, and its switches.

import { read } from "../languages/robot-command.js";
import { html, limited, live, nothing } from "../templates.js";
import { change, draft, rest } from "./gesture-draft.js";

/** @import { Outlook, SwitchName } from "../core/types.d.ts" */

/** @import { Draft } from "./gesture-draft.js" */

/** @typedef {{ name: SwitchName, title: string, words: Record<Draft[SwitchName], string> }} Switch */

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
 * @param {{ rows: number, problem?: string | null, hint: string, spellcheck?: boolean }} about
 */
function field(name, label, { rows, problem, hint, spellcheck = true }) {
  const value = draft()[name];
  const typed = (/** @type {any} */ { target }) => change({ [name]: target.value }, name);
  const id = `editor-${name}`;
  const input =
    rows === 1
      ? html`<input
          type="text"
          autocomplete="off"
          required
          id=${id}
          aria-describedby="${id}-note"
          aria-invalid=${Boolean(problem)}
          .value=${live(value)}
          @input=${typed}
          @blur=${rest}
          ${limited(MOST[name])}
        />`
      : html`<textarea
          rows=${rows}
          spellcheck=${spellcheck}
          id=${id}
          aria-describedby="${id}-note"
          aria-invalid=${Boolean(problem)}
          .value=${live(value)}
          @input=${typed}
          @blur=${rest}
          ${limited(MOST[name])}
        ></textarea>`;
  return html`<div class="field">
    <label for=${id}>${label}</label>${input}
    <p class=${problem ? "field-problem" : "dim"} id="${id}-note">${problem ?? hint}</p>
  </div>`;
}

/**
 * The text fields, and what is invalid in them.
 *
 * @param {string[]} taken
 */
export function texts(taken) {
  const { problem, kind } = read(draft().command);
  return html`<section class="panel words" aria-label="Texts">
    <h2>Texts</h2>
    ${field("label", "Label", {
      rows: 1,
      problem: labelProblem(draft().label, taken),
      hint: "The name that the recogniser returns: circle, ascend, follow me.",
    })}${field("description", "Description", {
      rows: 2,
      hint: "What it looks like or means, for people.",
    })}${field("command", "Command", {
      rows: 3,
      problem,
      hint: `For the robot, in words or as a JSON object; now: ${kind}.`,
      spellcheck: false,
    })}
  </section>`;
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

/**
 * @param {Switch} choice
 * @param {Outlook | null} found
 */
function choice({ name, title, words }, found) {
  const chosen = draft()[name];
  const settled = chosen === "auto" ? found?.switches[name] : undefined;
  const options = POSITIONS.map((position) => {
    const id = `switch-${name}-${position}`;
    return html`<input
        type="radio"
        name="switch-${name}"
        value=${position}
        id=${id}
        .checked=${live(position === chosen)}
        @change=${() => change({ [name]: position })}
      /><label for=${id} title=${words[position]}
        >${position[0].toUpperCase() + position.slice(1)}</label
      >`;
  });
  return html`<fieldset class="switch">
    <legend>${title}</legend>
    <div class="segments">${options}</div>
    <p class="dim">${words[chosen]}.</p>
    ${
      settled?.position === chosen ? html`<p class="comes-to">Here: ${settled.words}.</p>` : nothing
    }
  </fieldset>`;
}

/**
 * The switches, and what the automatic ones resolve to.
 *
 * @param {Outlook | null} found
 */
export const switches = (found) =>
  html`<section class="panel switches" aria-label="Switches">
    <h2>Switches</h2>
    ${SWITCHES.map((each) => choice(each, found))}
  </section>`;
