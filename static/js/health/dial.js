// The dial: how many right takes may be refused, with both costs of the limit that follows from it.

import * as api from "../core/api.js";
import { h, WRITES } from "../core/dom.js";
import { currentLanguage, follow } from "../core/state.js";
import { complain } from "../core/toasts.js";
import { showDone } from "../core/undo.js";
import { edit } from "../languages/revision-edit.js";
import { costWords, percent } from "./rates.js";

const SHARES = [0.02, 0.05, 0.1, 0.2];

/** @param {number} share */
async function turn(share) {
  const words = `Refusing at most ${percent(share)} % of right takes`;
  try {
    await edit(words, words, (language) => api.languages.change(language, { most_refused: share }));
    showDone(words, currentLanguage().name);
  } catch (error) {
    complain(error, words);
  }
}

/** Make the section, and keep it in step with the language and its report. */
export function dialSection() {
  const select = h("select", { id: "dial", ...WRITES });
  select.onchange = async () => {
    await turn(Number(select.value));
    choose(currentLanguage().most_refused); // Also where the change was refused.
  };
  /** @param {number} share */
  const choose = (share) => {
    const shares = [...new Set([...SHARES, share])].sort((one, other) => one - other);
    if (shares.length !== select.options.length || !shares.includes(Number(select.value)))
      select.replaceChildren(
        ...shares.map((each) => h("option", { value: each }, `${percent(each)} %`)),
      );
    select.value = String(share);
  };
  const costs = h("div", { className: "dial-costs", role: "status" });
  const section = h(
    "section",
    { className: "health-section dial", "aria-labelledby": "dial-title", hidden: true },
    h(
      "div",
      { className: "section-head" },
      h("h2", { id: "dial-title" }, "What is rejected"),
      h(
        "p",
        { className: "dim" },
        "The limit trades right takes that are refused for other signs that are accepted.",
      ),
    ),
    h("label", { for: "dial" }, "Right takes refused, at most ", select),
    costs,
  );
  let drawn = "";
  follow(["gestures", "health"], ({ gestures, health }) => {
    const limit = gestures && health?.id === gestures.id ? health.report?.limit : null;
    section.hidden = !limit || !gestures?.gestures.length;
    if (!gestures || !limit) return;
    choose(gestures.most_refused);
    select.disabled = !limit.measured;
    costs.classList.toggle("stale", health?.status !== "done");
    const words = costWords(limit);
    if (words.join() === drawn) return; // A status that is written again is read out again.
    drawn = words.join();
    costs.replaceChildren(...words.map((each) => h("p", {}, each)));
  });
  return section;
}
