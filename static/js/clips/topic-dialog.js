// The dialog that chooses the topic of a dive recording.

import * as api from "../core/api.js";
import { closeDialog, showDialog } from "../core/dialogs.js";
import { byId, disableDuring } from "../core/dom.js";
import { duration, plural } from "../core/format.js";
import { elementOf, html } from "../templates.js";

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
  return html`<label class="topic-choice">
    <input type="radio" name="topic" value=${topic.name} .checked=${chosen} />
    <span
      ><b>${topic.name}</b><span>${USES[topic.use]}</span><span class="dim">${facts}</span></span
    >
    <small class="dim num">${duration(topic.duration)}, ${plural(topic.messages, "message")}</small>
  </label>`;
}

/**
 * The panel that is shown until a topic is chosen.
 *
 * @param {Clip} clip
 */
export const topicsPanel = (clip) =>
  elementOf(
    html`<div class="welcome-progress topics-panel">
      <h1>This recording holds ${plural(clip.topics.length, "topic")}</h1>
      <p class="dim">One of them becomes the clip: the one that shows the diver.</p>
      <button type="button" class="primary" @click=${() => openTopics(clip)}>Choose a topic</button>
    </div>`,
  );

/**
 * Let the user choose the topic from which a dive recording's clip is made.
 *
 * @param {Clip} clip
 */
export function openTopics(clip) {
  if (byId("dialog").open) return; // its card asks again
  /** @param {SubmitEvent & { target: any }} event */
  const choose = async (event) => {
    event.preventDefault();
    const { target: form, submitter } = event;
    const confirm = /** @type {HTMLButtonElement} */ (submitter);
    const topic = String(new FormData(form).get("topic"));
    try {
      await disableDuring(confirm, () => api.clips.chooseTopic(clip.id, topic));
      closeDialog();
    } catch (error) {
      const problem = form.querySelector(".field-problem");
      problem.textContent = error.message;
      problem.hidden = false;
    }
  };
  showDialog(
    elementOf(
      html`<form method="dialog" class="topics-dialog" @submit=${choose}>
        <h2 id="dialog-title">Choose a topic</h2>
        <p class="dim">
          ${clip.name} holds ${plural(clip.topics.length, "topic")} that can become a clip. Choose
          the one that shows the diver.
        </p>
        <div role="radiogroup" aria-label="Topic" class="topic-choices">
          ${clip.topics.map((topic, index) => choice(topic, index === 0))}
        </div>
        <p class="field-problem" role="alert" hidden></p>
        <div class="dialog-actions">
          <button type="button" @click=${closeDialog}>Later</button>
          <button type="submit" class="primary">Find poses</button>
        </div>
      </form>`,
    ),
  );
}
