// The test set of the language on display: its labelled takes, recognised again after each change.

import * as api from "../core/api.js";
import { plural } from "../core/format.js";
import { loadList, outdate } from "../core/list-refresh.js";
import { mayWrite } from "../core/session.js";
import { follow, state, update } from "../core/state.js";
import { attempt, complain, toast } from "../core/toasts.js";
import { go } from "../core/views.js";

/** @import { TestSet } from "../core/types.d.ts" */

export const NONE = "none of these"; // Name of what shows none of the gestures.

/**
 * What a request says of the gesture that is expected.
 *
 * @param {string | null} expected a label, `NONE`, or null for nothing
 */
export const expectation = (expected) =>
  expected === NONE ? { expected_none: true } : { expected };

/**
 * What is expected of a take, as the page names it; null for nothing.
 *
 * @param {{ expected: string | null, expected_none?: boolean }} take
 */
export const expectedOf = ({ expected, expected_none: none }) => (none ? NONE : expected);

const MOST_UNASKED = 30; // Takes that are recognised again unasked: a few seconds' work.

/** @type {Promise<unknown> | null} */
let running = null;

/**
 * Show the test set that a change returned.
 *
 * @param {TestSet | null} testSet
 */
function show(testSet) {
  outdate("takes");
  draw(testSet);
}

/** @param {TestSet | null} testSet */
function draw(testSet) {
  if (testSet && testSet.language_id === state.language) update({ testSet });
}

/** Load the test set of the language on display. */
export async function loadTestSet() {
  const { language } = state;
  if (!language) return update({ testSet: null });
  const load = () => loadList("takes", () => api.testSets.get(language));
  draw(await attempt("Loading the test set", load));
  return undefined;
}

/** Recognise the takes that the newest revision has not recognised; one run at a time. */
export function runTestSet() {
  running ??= runNow().finally(() => {
    running = null;
    update({ testing: null });
  });
  return running;
}

/** Run after a change of the takes or the language, which a run under way does not include. */
export async function runWithNews() {
  await running;
  await runTestSet();
}

async function runNow() {
  const { language } = state;
  if (!language || !mayWrite()) return;
  update({ testing: { id: language, done: 0, total: state.testSet?.waiting ?? 0 } });
  try {
    show(await api.testSets.run(language));
  } catch (error) {
    if (error.code === "test_run_cancelled") await loadTestSet();
    else if (!api.isAway(error)) complain(error, "Testing");
  }
}

/** Cancel the run; what is done is kept. */
export const cancelTestRun = () =>
  attempt("Cancelling", () => api.testSets.cancel(state.language ?? ""));

/** @typedef {{ clip_id: string, expected: string, start?: number, end?: number }} LabelledRange */

/**
 * Add takes, or relabel existing ones, without recognising them yet.
 *
 * @param {LabelledRange[]} takes
 */
export async function putIntoTestSet(takes) {
  const drafts = takes.map(({ expected, ...range }) => ({ ...range, ...expectation(expected) }));
  show(await api.testSets.add(state.language ?? "", drafts));
}

/**
 * Add takes, or relabel existing ones, and recognise them.
 *
 * @param {LabelledRange[]} takes
 */
export async function addToTestSet(takes) {
  await putIntoTestSet(takes);
  await runWithNews();
}

/**
 * Give a take another label.
 *
 * @param {string} take
 * @param {string} expected
 */
export async function labelTake(take, expected) {
  show(
    await attempt("Labelling", () =>
      api.testSets.label(state.language ?? "", take, expectation(expected)),
    ),
  );
  await runWithNews();
}

/**
 * Remove a take from the test set.
 *
 * @param {string} take
 */
export async function removeTake(take) {
  show(await attempt("Leaving out", () => api.testSets.remove(state.language ?? "", take)));
}

/**
 * What a change of the language did to the takes that can be compared, in words; empty where
 * nothing changed.
 *
 * @param {Pick<TestSet, "better" | "worse" | "takes">} testSet
 */
export function changeWords({ better, worse, takes }) {
  const apart = takes.filter((take) => !take.set_aside && !(take.result && take.before)).length;
  const changes = [
    worse.length ? `${plural(worse.length, "take")} worse` : "",
    better.length ? `${plural(better.length, "take")} better` : "",
  ].filter(Boolean);
  if (!changes.length) return "";
  const others = apart ? `; ${plural(apart, "take")} cannot be compared` : "";
  return `${changes.join(", ")} since the revision before${others}`;
}

/** After an edit of the language: recognise the takes again, and show which got better or worse. */
async function testAgain() {
  await loadTestSet();
  const { testSet } = state;
  if (!testSet?.waiting || testSet.takes.length > MOST_UNASKED) return;
  await runWithNews();
  const now = state.testSet;
  const words = now && now.revision > testSet.revision - 1 ? changeWords(now) : "";
  if (words && now?.language_id === testSet.language_id)
    toast("The test set has changed", `${words}.`, {
      action: { label: "Show", run: () => go("health") },
    });
}

/** Keep the test set up to date with the language on display and with other pages. */
export function followTestSet() {
  let shown = "";
  follow(["gestures"], ({ gestures }) => {
    const now = gestures ? `${gestures.id} ${gestures.revision}` : "";
    if (now === shown) return;
    const same = gestures && shown.startsWith(`${gestures.id} `);
    shown = now;
    if (same) testAgain();
    else loadTestSet();
  });
  follow(["returns"], ({ returns }) => {
    if (returns && !running) loadTestSet();
  });
  follow(["labelled"], ({ labelled }) => {
    if (labelled && labelled.id === state.language && !running) loadTestSet();
  });
}
