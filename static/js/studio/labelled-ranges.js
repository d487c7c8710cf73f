// Ranges of a clip that were labelled by hand, saved together as gestures or as takes to test.

import { tabStore } from "../core/browser-store.js";
import { byId, disableDuring, h, WRITES } from "../core/dom.js";
import { moment, plural } from "../core/format.js";
import { selectedClip, selectedRange, state, update } from "../core/state.js";
import { limit } from "../core/text-limit.js";
import { attempt, toast } from "../core/toasts.js";
import { saveInto } from "../gestures/gesture-table.js";
import { addToTestSet } from "../languages/test-set.js";

/** @import { SelectedRange, State } from "../core/types.d.ts" */

const KEY = "osg-studio.ranges"; // They survive a reload.
const ASKS = "What this range shows";

const names = { placeholder: ASKS, "aria-label": ASKS };
const field = h("input", { type: "text", autocomplete: "off", ...names });
const form = h("form", { className: "joined" }, field, h("button", {}, "Add range"));
const send = h("button", WRITES);

const here = () => state.ranges.filter(({ clip_id }) => clip_id === state.clip);

/** Whether the ranges are takes of gestures that the language has. */
const areTests = () => here().every(({ label }) => state.gestures?.labels.includes(label));

/** @param {State["ranges"]} ranges */
function keep(ranges) {
  tabStore.write(KEY, ranges);
  update({ ranges });
}

/**
 * The labelled ranges along the timeline; a press takes one out again, to change or to drop it.
 *
 * @param {number} last second of the clip
 */
const bars = (last) =>
  here().map((range) => {
    const { label, start, end } = range;
    const onclick = () => {
      keep(state.ranges.filter((each) => each !== range));
      field.value = label;
      update({ take: null, recognition: null, start, end });
    };
    const [left, width] = [start, end - start].map((part) => `${(100 * part) / last}%`);
    return h(
      "button",
      {
        type: "button",
        title: `${label}: ${moment(start)} to ${moment(end)}. Press to change it.`,
        style: { "margin-left": left, width },
        onclick,
      },
      label,
    );
  });

/**
 * Build the field that labels the range chosen by hand; `hasLanguage()` asks for one to save into.
 *
 * @param {() => Promise<boolean>} hasLanguage
 */
export function buildRanges(hasLanguage) {
  limit(field, 80);
  form.onsubmit = (event) => {
    event.preventDefault();
    const label = field.value.trim();
    const { start, end } = /** @type {SelectedRange} */ (selectedRange());
    if (!label || !state.clip) return field.focus();
    // One gesture has one range: a range in the place of others takes theirs.
    const kept = state.ranges.filter(
      (each) => each.end <= start || end <= each.start || each.clip_id !== state.clip,
    );
    keep([...kept, { label, clip_id: state.clip, start, end }]);
    field.value = "";
  };
  send.onclick = async () => {
    const [ranges, tests] = [here(), areTests()];
    if (!tests && !(await hasLanguage())) return;
    const save = async () => {
      if (!tests) await saveInto(state.language ?? "", ranges);
      else await addToTestSet(ranges.map(({ label, ...at }) => ({ ...at, expected: label })));
      return true;
    };
    const saved = await disableDuring(send, () => attempt("Saving the ranges", save));
    if (saved) keep(state.ranges.filter((each) => !ranges.includes(each)));
    if (saved && tests) toast("In the test set", "They are recognised again after every change.");
  };
  byId("ranges").replaceChildren(form, send);
  update({ ranges: tabStore.read(KEY) ?? [] });
}

/**
 * Show the field where a range is chosen by hand, and the button that saves the labelled ones.
 *
 * @param {State} state
 */
export function drawRanges({ takes, take, start, end, timeline }) {
  const along = document.getElementById("labelled-ranges");
  along?.replaceChildren(...bars(timeline?.time.at(-1) || 1));
  const byHand = take === null && (start !== null || end !== null);
  const done = selectedClip()?.status === "done" && takes;
  byId("ranges").hidden = !done || (!byHand && !here().length);
  form.hidden = !byHand;
  send.hidden = !here().length;
  send.textContent = areTests()
    ? `Keep ${plural(here().length, "range")} as tests`
    : `Save ${plural(here().length, "gesture")}`;
}
