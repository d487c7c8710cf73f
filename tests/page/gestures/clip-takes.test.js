import assert from "node:assert/strict";
import { test } from "node:test";

import { update } from "../../../static/js/core/state.js";
import {
  forgetFailures,
  loadTakesOfClips,
  takesByClip,
} from "../../../static/js/gestures/clip-takes.js";

/** Wait until what others do has come true. */
async function until(holds) {
  for (let turn = 0; !holds(); turn += 1) {
    assert.ok(turn < 200);
    await new Promise((go) => setTimeout(go, 5));
  }
}

const clips = (prefix, count) =>
  Array.from({ length: count }, (_, number) => ({ id: `${prefix}${number}`, status: "done" }));

/** Load the takes of the clips, as the open table does. */
const load = ({ wanted = () => true, found = () => {} } = {}) => loadTakesOfClips(wanted, found);

/** Let what has been answered have its effect. */
async function settle() {
  for (let turn = 0; turn < 20; turn += 1) await new Promise(setImmediate);
}

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
      await settle();
    },
  };
}

test("the takes of many clips are asked for a few at a time", async (t) => {
  const { waiting, one } = answers(t);
  update({ clips: [{ id: "queued", status: "queued" }, ...clips("a", 9)] });
  let drawn = 0;
  const draw = () => (drawn += 1);
  load({ found: draw });
  load({ found: draw });
  assert.equal(waiting.length, 4);
  await one();
  assert.equal(waiting.length, 4);
  assert.deepEqual([...takesByClip.keys()], ["a0"]);
  while (waiting.length) await one();
  assert.equal(takesByClip.size, 9);
  assert.equal(drawn, 9);
  load();
  assert.equal(waiting.length, 0);
});

test("what is on its way is not asked for again when the table is opened again", async (t) => {
  const { waiting, one } = answers(t);
  update({ clips: clips("c", 2) });
  const open = () => {
    forgetFailures();
    load();
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
  const wanted = () => open;
  load({ wanted });
  open = false;
  while (waiting.length) await one();
  assert.equal([...takesByClip.keys()].filter((id) => id.startsWith("b")).length, 4);
  open = true;
  load({ wanted });
  assert.equal(waiting.length, 2);
  while (waiting.length) await one();
});

test("a clip whose takes the server refuses does not hold up the others", async (t) => {
  const asked = [];
  t.mock.method(globalThis, "fetch", async (address) => {
    asked.push(String(address));
    // Cancelled is the one error without a toast, which needs a page.
    if (asked.at(-1).includes("d1")) return Response.json({ code: "cancelled" }, { status: 409 });
    return Response.json([]);
  });
  update({ clips: clips("d", 6) });
  load();
  await until(() => asked.length === 6);
  load();
  assert.equal(asked.length, 6, "not again while the table is open");
  forgetFailures();
  load();
  await until(() => asked.length === 7);
  assert.match(asked[6], /d1/);
  await settle();
});

test("without a server nothing more is asked for, and everything once it is back", async (t) => {
  const asked = [];
  let away = true;
  t.mock.method(globalThis, "fetch", async (address) => {
    asked.push(String(address));
    if (away) throw new TypeError("fetch failed");
    return Response.json([]);
  });
  update({ clips: clips("e", 9) });
  load();
  await settle();
  assert.equal(asked.length, 4);
  away = false;
  load();
  await until(() => asked.length === 4 + 9);
});
