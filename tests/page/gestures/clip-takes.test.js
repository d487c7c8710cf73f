import assert from "node:assert/strict";
import { test } from "node:test";

import { update } from "../../../static/js/core/state.js";
import { forgetFailures, loadTakes, takes } from "../../../static/js/gestures/clip-takes.js";

const clips = (prefix, count) =>
  Array.from({ length: count }, (_, number) => ({ id: `${prefix}${number}`, status: "done" }));

/** Answers that come one at a time. */
function answers(t) {
  const waiting = [];
  t.mock.method(globalThis, "fetch", async (address) => {
    await new Promise((go) => waiting.push(go));
    return Response.json([{ start: 1, clip: String(address) }]);
  });
  return {
    waiting,
    async one() {
      waiting.shift()();
      for (let turn = 0; turn < 5; turn += 1) await new Promise(setImmediate);
    },
  };
}

test("the takes of many clips are asked for a few at a time", async (t) => {
  const { waiting, one } = answers(t);
  update({ clips: [{ id: "queued", status: "queued" }, ...clips("a", 9)] });
  let drawn = 0;
  const load = () =>
    loadTakes(
      () => true,
      () => (drawn += 1),
    );
  load();
  load();
  assert.equal(waiting.length, 4);
  await one();
  assert.equal(waiting.length, 4);
  assert.deepEqual([...takes.keys()], ["a0"]);
  while (waiting.length) await one();
  assert.equal(takes.size, 9);
  assert.equal(drawn, 9);
  load();
  assert.equal(waiting.length, 0);
});

test("what is on its way is not asked for again when the table is opened again", async (t) => {
  const { waiting, one } = answers(t);
  update({ clips: clips("c", 2) });
  const open = () => {
    forgetFailures();
    loadTakes(
      () => true,
      () => {},
    );
  };
  open();
  open();
  assert.equal(waiting.length, 2);
  while (waiting.length) await one();
});

test("no more are asked for once nobody wants them, and the rest at the next time", async (t) => {
  const { waiting, one } = answers(t);
  update({ clips: clips("b", 6) });
  let open = true;
  const load = () =>
    loadTakes(
      () => open,
      () => {},
    );
  load();
  open = false;
  while (waiting.length) await one();
  assert.equal([...takes.keys()].filter((id) => id.startsWith("b")).length, 4);
  open = true;
  load();
  assert.equal(waiting.length, 2);
  while (waiting.length) await one();
});
