// Clips on their way into the test set: they wait for their poses, or for a label.

import { labelInName } from "../clips/clip-label.js";
import { BUSY } from "../clips/batch.js";
import { clipsOfDemonstrations } from "../clips/demonstration-ranges.js";
import * as api from "../core/api.js";
import { tabStore } from "../core/browser-store.js";
import { currentLanguage, state, update } from "../core/state.js";
import { complain, toast } from "../core/toasts.js";
import { addToTestSet, putIntoTestSet, removeTake, runWithNews } from "../languages/test-set.js";
import { addFiles } from "../upload/upload-list.js";

/** @import { Clip, LabelledTake, PendingClip, TestSet } from "../core/types.d.ts" */

const KEY = "osg-studio.batch"; // Clips that wait for their poses.

update({ pending: tabStore.read(KEY) ?? [] });

/** @param {PendingClip[]} pending */
function setPending(pending) {
  update({ pending });
  tabStore.write(KEY, pending);
}

/**
 * Take clips into the test, each with the label that its name begins with.
 *
 * @param {Iterable<File>} files
 */
export function addTestClips(files) {
  addFiles(files, (id) =>
    setPending([...state.pending, { clip: id, language: state.language, expected: null }]),
  );
}

/**
 * Take clips of the library into the test.
 *
 * @param {string[]} ids
 */
export const addLibraryClips = (ids) =>
  setPending([
    ...state.pending,
    ...ids.map((clip) => ({ clip, language: state.language, expected: null })),
  ]);

/**
 * The clips of the library that are not in the test, with the label that their name suggests.
 *
 * @param {TestSet} testSet of the language on display
 */
export function candidates(testSet) {
  const { labels } = currentLanguage();
  const taken = new Set([
    ...testSet.takes.map(({ clip_id }) => clip_id),
    ...state.pending.filter(({ language }) => language === state.language).map(({ clip }) => clip),
    ...clipsOfDemonstrations(state.gestures),
  ]);
  return state.clips
    .filter(({ id, status }) => status === "done" && !taken.has(id))
    .map((clip) => ({ clip, expected: labelInName(clip.name, labels) }));
}

/**
 * The expected label of a pending clip: as chosen, or as its name suggests.
 *
 * @param {PendingClip} pending
 */
export const meantBy = ({ clip, expected }) =>
  expected ??
  labelInName(state.clips.find(({ id }) => id === clip)?.name ?? "", state.gestures?.labels ?? []);

/**
 * Set the expected label of a pending clip.
 *
 * @param {string} clip
 * @param {string} expected
 */
export const means = (clip, expected) =>
  setPending(state.pending.map((each) => (each.clip === clip ? { ...each, expected } : each)));

/**
 * Remove a clip from the waiting ones, because it is recognised or was left out.
 *
 * @param {string} clip
 */
const forget = (clip) => setPending(state.pending.filter((each) => each.clip !== clip));

/**
 * @param {string} name
 * @param {() => void} run
 */
const leftOut = (name, run) =>
  toast("Left out of the test", `${name} stays among the clips.`, {
    action: { label: "Undo", run },
  });

/**
 * Leave a clip out of the test that was not recognised yet.
 *
 * @param {Pick<Clip, "id" | "name">} clip
 */
export function leaveWaiting({ id, name }) {
  const kept = state.pending.find(({ clip }) => clip === id);
  forget(id);
  leftOut(name, () => setPending(kept ? [...state.pending, kept] : state.pending));
}

/**
 * Leave a take out of the test; `name` is what it is called.
 *
 * @param {Pick<LabelledTake, "id" | "clip_id" | "start" | "end"> & { expected: string }} take
 * @param {string} name
 */
export async function leaveOut({ id, clip_id, start, end, expected }, name) {
  await removeTake(id);
  leftOut(name, () => addToTestSet([{ clip_id, start, end, expected }]));
}

/**
 * Take a clip that is in the set now out of the waiting ones; what was changed meanwhile counts.
 *
 * @param {PendingClip} pending
 * @param {string | undefined} sent
 */
async function settle(pending, sent) {
  const kept = state.pending.find(isSame(pending));
  // Before the recognition, so that the clip is never in two rows.
  forget(pending.clip);
  if (!kept) return removeClip(pending.clip); // Left out in the meantime.
  const expected = meantBy(kept);
  return expected === sent ? undefined : putIntoTestSet([{ clip_id: pending.clip, expected }]);
}

let working = false;
let alone = false; // Whether clips are put into the set one by one, because one of them is refused.

/**
 * Put the clips whose poses are there and whose label is known into the test set, all at once: the
 * server then recognises them, whether this page stays open or not.
 */
export async function workOff() {
  if (working) return;
  working = true;
  for (let batch = ready(); batch.length; batch = ready()) {
    if (alone) batch = batch.slice(0, 1);
    const takes = batch.map((each) => ({ clip_id: each.clip, expected: meantBy(each) }));
    try {
      await putIntoTestSet(takes);
      for (const [place, each] of batch.entries()) await settle(each, takes[place]?.expected);
      await runWithNews();
    } catch (error) {
      if (api.isAway(error)) break; // They stay pending until the server is back.
      alone = batch.length > 1;
      if (alone) continue;
      const [{ clip }] = batch;
      complain(error, `Testing ${state.clips.find(({ id }) => id === clip)?.name ?? "a clip"}`);
      forget(clip);
    }
  }
  working = alone = false;
}

/**
 * @param {PendingClip} pending
 * @returns {(other: PendingClip) => boolean}
 */
const isSame =
  ({ clip, language }) =>
  (other) =>
    other.clip === clip && other.language === language;

/**
 * Remove the takes of a clip from the test set.
 *
 * @param {string} clip
 */
async function removeClip(clip) {
  for (const take of (state.testSet?.takes ?? []).filter(({ clip_id }) => clip_id === clip))
    await removeTake(take.id);
}

function ready() {
  if (!state.gestures?.gestures.length) return [];
  const done = new Set(state.clips.filter(({ status }) => status === "done").map(({ id }) => id));
  return state.pending.filter(
    (each) => each.language === state.language && done.has(each.clip) && meantBy(each),
  );
}

/**
 * Clips of the test that are not recognised yet, as `{ clip, expected, busy }` with the clip
 * itself.
 */
export function waitingClips() {
  return state.pending
    .filter(({ language }) => language === state.language)
    .map((each) => {
      const clip = state.clips.find(({ id }) => id === each.clip);
      return clip && { clip, expected: meantBy(each), busy: BUSY.has(clip.status) };
    })
    .filter((each) => each !== undefined);
}
