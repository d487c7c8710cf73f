// The gestures of the language, as cards with their trajectory images.

import * as api from "../core/api.js";
import { byId, h, iconButton, reconcile } from "../core/dom.js";
import { readable } from "../core/format.js";
import { reloadLanguage } from "../languages/language-store.js";
import { selectedClip, state, update } from "../core/state.js";
import { complain } from "../core/toasts.js";
import { did, tellDone } from "../core/undo.js";
import { go } from "../core/views.js";

/**
 * Change the language by `change(base)`, which calls the API with the revision `base`; it can be
 * taken back under `title`. `from` is what the user saw when beginning, `mine` what it would be
 * like then: both are shown when someone else was faster, and the user picks.
 */
export async function edit(doing, title, change, { from = state.gestures, mine = from } = {}) {
  let made;
  try {
    made = { before: from.revision, language: await change(from) };
  } catch (error) {
    if (error.status !== 412) throw error;
    const { settleRace } = await import("../languages/edit-conflict.js");
    await reloadLanguage();
    made = await settleRace({ doing, title, from, mine, change });
  }
  const { before, language } = made;
  if (state.language === language.id) update({ gestures: language });
  did({ title, kind: "edit", language: language.id, before, after: language.revision });
  return language;
}

async function remove(gesture) {
  const from = state.gestures;
  const mine = { ...from, gestures: from.gestures.filter((each) => each.label !== gesture.label) };
  try {
    await edit(
      "Deleting the gesture",
      `Deletion of ${gesture.label}`,
      (language) => api.languages.removeGesture(language, gesture.label),
      { from, mine },
    );
    tellDone("Gesture deleted", gesture.label);
  } catch (error) {
    complain(error, "Deleting the gesture");
  }
}

function draw(gesture, element) {
  const { revision } = state.gestures;
  const mark =
    state.result &&
    (gesture.label === state.result.label
      ? "chosen"
      : gesture.label === state.result.expected
        ? "expected"
        : null);
  const signature = JSON.stringify([gesture, mark]);
  if (element?.dataset.signature === signature) return element;
  const image = `${gesture.thumbnail}${gesture.thumbnail.includes("revision=") ? "" : `?revision=${revision}`}`;
  const card = h(
    "li",
    { className: `card${mark ? ` ${mark}` : ""}` },
    h("img", {
      src: image,
      alt: `Trajectory of ${gesture.label}`,
      loading: "lazy",
      width: 112,
      height: 112,
    }),
    h(
      "div",
      { className: "card-text" },
      h("b", { title: gesture.label }, gesture.label),
      h("span", {}, gesture.description || gesture.salient.map(readable).join(", ")),
      mark ? h("span", { className: `tag ${mark}` }, mark) : null,
    ),
    h(
      "div",
      { className: "card-buttons" },
      iconButton("rename", `Change ${gesture.label}`, () =>
        go("gesture", { gesture: gesture.label }),
      ),
      iconButton("trash", `Delete ${gesture.label}`, () => remove(gesture)),
    ),
  );
  card.dataset.signature = signature;
  return card;
}

export function drawGestures({ gestures, result }) {
  const members = gestures?.gestures ?? [];
  byId("gesture-count").textContent = members.length ? String(members.length) : "";
  const empty = byId("gestures-empty");
  empty.hidden = members.length > 0;
  empty.textContent = gestures
    ? "No gestures yet. Select a take of a clip and press \u201cSave as gesture\u201d: one demonstration is enough."
    : "No language yet. Make one with +, or drop a language file (.json).";
  reconcile(byId("gestures"), members, (gesture) => gesture.label, draw);
  drawExpected(members, result);
}

let shown = { result: null, clip: null };

/** The words and numbers of a name, with a space around each. */
const words = (name) => ` ${(name.toLowerCase().match(/\p{L}+|\p{N}+/gu) ?? []).join(" ")} `;

/**
 * A clip called "circle-2.mp4" is probably meant as a circle, "unfinished triangle" as a triangle;
 * what its name begins with goes before what it mentions. Anyone can say otherwise.
 */
export function proposed(clip, members) {
  const name = words(clip?.name ?? "");
  const named = members
    .map(({ label }) => ({ label, at: words(label).trim() ? name.indexOf(words(label)) : -1 }))
    .filter(({ at }) => at >= 0);
  return (
    named.sort((one, other) => one.at - other.at || other.label.length - one.label.length)[0]
      ?.label ?? ""
  );
}

/** Offer the labels as what was meant; a recognition that is opened says it itself. */
function drawExpected(members, result) {
  const expected = byId("expected");
  const clip = selectedClip();
  let told = expected.value;
  if (result && result.id !== shown.result) told = result.expected ?? "";
  else if (clip?.id !== shown.clip) told = proposed(clip, members);
  shown = { result: result?.id ?? null, clip: clip?.id };
  expected.replaceChildren(
    h("option", { value: "" }, "not told"),
    ...members.map((gesture) => h("option", { value: gesture.label }, gesture.label)),
  );
  expected.value = members.some((gesture) => gesture.label === told) ? told : "";
}
