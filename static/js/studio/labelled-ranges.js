// Ranges of a clip that were labelled by hand, saved together as gestures or as takes to test.

import { byId, h, WRITES } from "../core/dom.js";
import { moment, plural } from "../core/format.js";
import { selectedRange, state, update } from "../core/state.js";
import { limit } from "../core/text-limit.js";
import { attempt, toast } from "../core/toasts.js";
import { saveInto } from "../gestures/gesture-table.js";
import { addToTestSet } from "../languages/test-set.js";

/** @import { SelectedRange, State } from "../core/types.d.ts" */

const KEY = "osg-studio.ranges"; // sessionStorage: they survive a reload.
const LONGEST_LABEL = 80;

const [field, add, done] = [h("input", { type: "text" }), h("button"), h("button", WRITES)];
const here = () => state.ranges.filter(({ clip_id }) => clip_id === state.clip);

/** Whether the ranges are takes of gestures that the language has. */
const areTests = () => here().every(({ label }) => state.gestures?.labels.includes(label));

/** @param {State["ranges"]} ranges */
function keep(ranges) {
  sessionStorage.setItem(KEY, JSON.stringify(ranges));
  update({ ranges });
}

/** @param {State["ranges"][number]} range */
function takeOut(range) {
  keep(state.ranges.filter((each) => each !== range));
  field.value = range.label;
  update({ take: null, recognition: null, start: range.start, end: range.end });
}

/**
 * The labelled ranges along the timeline, in lines of their own where they overlap; a press takes
 * one out again, to change or to drop it.
 *
 * @param {number} last second of the clip
 */
const bars = (last) =>
  here().map((range, index, all) => {
    const { label, start, end } = range;
    const line = 1 + all.slice(0, index).filter((one) => one.start < end && start < one.end).length;
    const [left, width] = [start, end - start].map((part) => `${(100 * part) / last}%`);
    return h(
      "button",
      {
        type: "button",
        title: `${label}: ${moment(start)} to ${moment(end)}. Press to change it.`,
        style: { "margin-left": left, width, "grid-row": String(line) },
        onclick: () => takeOut(range),
      },
      label,
    );
  });

async function save() {
  const [ranges, tests] = [here(), areTests()];
  const saved = await attempt("Saving the ranges", async () => {
    if (!tests) await saveInto(state.language ?? "", ranges);
    else await addToTestSet(ranges.map(({ label, ...at }) => ({ ...at, expected: label })));
    return true;
  });
  if (!saved) return;
  keep(state.ranges.filter((each) => !ranges.includes(each)));
  if (tests) toast("In the test set", "They are recognised again after every change.");
}

/**
 * Build the field that labels the range chosen by hand; `hasLanguage()` asks for one to save into.
 *
 * @param {() => Promise<boolean>} hasLanguage
 */
export function buildRanges(hasLanguage) {
  limit(field, LONGEST_LABEL).placeholder = "Label of this range";
  field.setAttribute("aria-label", field.placeholder);
  field.autocomplete = "off";
  add.textContent = "Add range";
  const form = h("form", { className: "joined" }, field, add);
  form.onsubmit = (event) => {
    event.preventDefault();
    const label = field.value.trim();
    const { start, end } = /** @type {SelectedRange} */ (selectedRange());
    if (!label || !state.clip) return field.focus();
    keep([...state.ranges, { label, clip_id: state.clip, start, end }]);
    field.value = "";
  };
  done.onclick = async () => {
    if (areTests() || (await hasLanguage())) save();
  };
  byId("ranges").replaceChildren(form, done);
  update({ ranges: JSON.parse(sessionStorage.getItem(KEY) ?? "[]") });
}

/**
 * Show the field where a range is chosen by hand, and the button that saves the labelled ones.
 *
 * @param {State} state
 */
export function drawRanges({ takes, take, start, end, timeline }) {
  const along = document.getElementById("labelled-ranges");
  along?.replaceChildren(...bars(timeline?.time.at(-1) || 1));
  const byHand = takes && take === null && (start !== null || end !== null);
  byId("ranges").hidden = !byHand && !(takes && here().length);
  if (field.parentElement) field.parentElement.hidden = !byHand;
  done.hidden = !here().length;
  done.textContent = areTests()
    ? `Keep ${plural(here().length, "range")} as tests`
    : `Save ${plural(here().length, "range")} as gestures`;
}
