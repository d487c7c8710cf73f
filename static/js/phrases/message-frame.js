// The panel of a message's frame: gestures that open, close and cancel it, and the longest pause.

import { asOptions, html } from "../templates.js";
import { choice, textField } from "./form-fields.js";
import { grammar, labels, save } from "./grammar-store.js";

/** @import { Role } from "./grammar-edits.js" */

/** @type {Record<Role, [string, string]>} */
const TEXTS = {
  start: ["Starts with", "none: any phrase may begin"],
  end: ["Ends with", "none: a pause ends it"],
  cancel: ["Cancelled by", "none"],
};

/** @param {Role} name */
function role(name) {
  const whole = grammar();
  const [label, none] = TEXTS[name];
  const others = name === "cancel" ? [whole.start, whole.end] : [whole.cancel];
  /** @type {[string, string][]} */
  const options = [["", none], ...asOptions(labels().filter((each) => !others.includes(each)))];
  return choice({
    id: `frame-${name}`,
    label,
    value: whole[name] ?? "",
    options,
    commit: (value) =>
      save(`${label} ${value || "none"}`, (base) => ({ ...base, [name]: value || null })),
  });
}

/** Draw the panel. */
export function framePanel() {
  const { timeout, most_phrases: most } = grammar();
  return html`<section class="panel" aria-labelledby="frame-title">
    <h2 id="frame-title">Around a message</h2>
    <p class="dim">
      An opening and a closing gesture prevent false alarms: gestures outside a message are ignored.
      A message may hold several phrases, each with its own opening gesture.
    </p>
    <div class="frame-fields">
      ${role("start")}${role("end")}${role("cancel")}${textField({
        id: "frame-timeout",
        label: "Longest pause (s)",
        value: String(timeout),
        number: { min: 1, max: 600, step: "any" },
        commit: (text) => save("Longest pause", (base) => ({ ...base, timeout: Number(text) })),
      })}${textField({
        id: "frame-most",
        label: "Phrases, at most",
        value: String(most),
        number: { min: 1, max: 8, step: 1 },
        commit: (text) =>
          save("Phrases in one message", (base) => ({ ...base, most_phrases: Number(text) })),
      })}
    </div>
  </section>`;
}
