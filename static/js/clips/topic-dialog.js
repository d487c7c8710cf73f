// The dialog that chooses the topic of a dive recording.

import * as api from "../core/api.js";
import { byId, h } from "../core/dom.js";
import { duration, plural } from "../core/format.js";

/** @import { Clip, Topic } from "../core/types.d.ts" */

/** @type {Record<string, string>} */
const USES = { pictures: "Pictures", keypoints: "Keypoints, shown as a skeleton" };

/**
 * @param {Topic} topic
 * @param {boolean} chosen
 */
function choice(topic, chosen) {
  const facts = [topic.type.replace("/msg/", "/"), `${topic.width} \u00d7 ${topic.height}`].join(
    "  \u00b7  ",
  );
  return h(
    "label",
    { className: "topic-choice" },
    h("input", { type: "radio", name: "topic", value: topic.name, checked: chosen }),
    h(
      "span",
      {},
      h("b", {}, topic.name),
      h("span", {}, USES[topic.use]),
      h("span", { className: "dim" }, facts),
    ),
    h(
      "small",
      { className: "dim num" },
      `${duration(topic.duration)}, ${plural(topic.messages, "message")}`,
    ),
  );
}

/**
 * The panel that is shown until a topic is chosen.
 *
 * @param {Clip} clip
 */
export const topicsPanel = (clip) =>
  h(
    "div",
    { className: "welcome-progress topics-panel" },
    h("h1", {}, `This recording holds ${plural(clip.topics.length, "topic")}`),
    h("p", { className: "dim" }, "One of them becomes the clip: the one that shows the diver."),
    h(
      "button",
      { type: "button", className: "primary", onclick: () => openTopics(clip) },
      "Choose a topic",
    ),
  );

/**
 * Let the user choose the topic from which a dive recording's clip is made.
 *
 * @param {Clip} clip
 */
export function openTopics(clip) {
  const dialog = byId("dialog");
  if (dialog.open) return; // its card asks again
  const problem = h("p", { className: "field-problem", role: "alert", hidden: true });
  const confirm = h("button", { type: "submit", className: "primary" }, "Find poses");
  const form = h(
    "form",
    { method: "dialog", className: "topics-dialog" },
    h("h2", { id: "dialog-title" }, "Choose a topic"),
    h(
      "p",
      { className: "dim" },
      `${clip.name} holds ${plural(clip.topics.length, "topic")} that can become a clip. Choose the one that shows the diver.`,
    ),
    h(
      "div",
      { role: "radiogroup", "aria-label": "Topic", className: "topic-choices" },
      clip.topics.map((topic, index) => choice(topic, index === 0)),
    ),
    problem,
    h(
      "div",
      { className: "dialog-actions" },
      h("button", { type: "button", onclick: () => dialog.close() }, "Later"),
      confirm,
    ),
  );
  form.onsubmit = async (event) => {
    event.preventDefault();
    confirm.disabled = true;
    try {
      await api.clips.chooseTopic(clip.id, String(new FormData(form).get("topic")));
      dialog.close();
    } catch (error) {
      problem.textContent = error.message;
      problem.hidden = false;
      confirm.disabled = false;
    }
  };
  dialog.replaceChildren(form);
  dialog.setAttribute("aria-labelledby", "dialog-title");
  dialog.onclose = null;
  dialog.showModal();
}
