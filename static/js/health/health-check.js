// The health check of the language on display: request, progress and cancelling.

import * as api from "../core/api.js";
import { currentLanguage, state, update } from "../core/state.js";

/** @import { HealthState, Language, State } from "../core/types.d.ts" */

/** @param {Pick<Language, "id" | "revision">} language */
const keyOf = ({ id, revision }) => `${id} ${revision}`;

/**
 * Whether a report is of the language and revision on display.
 *
 * @param {HealthState | null} health
 */
export const isCurrent = (health) =>
  Boolean(health && state.gestures && health.key === keyOf(state.gestures));

/**
 * Check the revision on display and put the report into `state.health`; until it is complete, the
 * previous revision's report stays on display.
 */
export async function check() {
  const language = currentLanguage();
  const key = keyOf(language);
  const { testSet } = state;
  const known = state.health?.id === language.id ? state.health : null;
  const base = {
    key,
    id: language.id,
    revision: language.revision,
    report: known?.report ?? null,
    shown: known?.shown ?? null,
  };
  /** @param {Pick<HealthState, "status"> & Partial<HealthState>} change */
  const settle = (change) => {
    if (state.health?.key === key) update({ health: { ...base, ...change } });
  };
  update({ checking: null, health: { ...base, status: "checking" } });
  try {
    const report = await api.languages.check(language.id, language.revision);
    settle({ status: "done", report, shown: language.revision });
    if (state.testSet !== testSet) judgeAgain(state);
  } catch (error) {
    settle(
      error.code === "check_cancelled"
        ? { status: "cancelled" }
        : { status: "failed", error: error.message, away: api.isAway(error) },
    );
  }
}

/**
 * Check again if another revision is on display than was checked, or if the server was away.
 *
 * @param {State} state
 */
export function keepChecked({ view, gestures, health }) {
  if (view === "health" && gestures?.gestures.length && (!isCurrent(health) || health?.away))
    check();
}

let judged = 0; // Number of verdicts that were asked for; only the last one is shown.

/**
 * Take the verdict after a change of the test set; the server keeps the check itself.
 *
 * @param {State} state
 */
export async function judgeAgain({ view, health }) {
  if (view !== "health" || !health || !isCurrent(health) || health.status !== "done") return;
  judged += 1;
  const mine = judged;
  const report = await api.languages.check(health.id, health.revision).catch(() => null);
  const { health: shown } = state;
  if (report && mine === judged && shown?.key === health.key && shown.status === "done")
    update({ health: { ...shown, report } });
}

/** Cancel the check that runs. */
export const cancel = () =>
  state.health && api.languages.cancelCheck(state.health.id, state.health.revision);
