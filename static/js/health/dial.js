// The dial: how many right takes may be refused, with both costs of the limit that follows from it.

import * as api from "../core/api.js";
import { currentLanguage } from "../core/state.js";
import { html, live } from "../templates.js";
import { editAndShow } from "../languages/revision-edit.js";
import { costWords, percent } from "./rates.js";

/** @import { HealthReport, State } from "../core/types.d.ts" */

const SHARES = [0.02, 0.05, 0.1, 0.2];

/** @param {number} share */
function turn(share) {
  const words = `Refusing at most ${percent(share)} % of right takes`;
  return editAndShow(
    words,
    words,
    (language) => api.languages.change(language, { most_refused: share }),
    ({ name }) => [words, name],
  );
}

/** @param {Event & { target: HTMLSelectElement }} event */
async function choose({ target }) {
  await turn(Number(target.value));
  target.value = String(currentLanguage().most_refused); // Also where the change was refused.
}

/**
 * The section, as the language and its report have it.
 *
 * @param {State} state
 * @param {HealthReport | null} report
 */
export function dialSection({ gestures, health }, report) {
  const limit = report?.limit;
  const now = gestures?.most_refused ?? SHARES[0];
  const shares = [...new Set([...SHARES, now])].sort((one, other) => one - other);
  return html`<section
    class="health-section dial"
    aria-labelledby="dial-title"
    ?hidden=${!limit || !gestures?.gestures.length}
  >
    <div class="section-head">
      <h2 id="dial-title">What is rejected</h2>
      <p class="dim">
        The limit trades right takes that are refused for other signs that are accepted.
      </p>
    </div>
    <label for="dial"
      >Right takes refused, at most
      <select id="dial" data-writes ?disabled=${!limit?.measured} @change=${choose}>
        ${shares.map(
          (share) =>
            html`<option value=${share} .selected=${live(share === now)}>
              ${percent(share)} %
            </option>`,
        )}
      </select></label
    >
    <div class="dial-costs ${health?.status === "done" ? "" : "stale"}" role="status">
      ${limit ? costWords(limit).map((each) => html`<p>${each}</p>`) : ""}
    </div>
  </section>`;
}
