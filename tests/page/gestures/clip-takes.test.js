import assert from "node:assert/strict";
import { test } from "node:test";

import "../relative-requests.js";
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

/** Let what has been asked and answered have its effect. */
async function settle() {
  for (let turn = 0; turn < 20; turn += 1) await new Promise(setImmediate);
}

/** Load the takes of the clips, as the open table does. */
async function load({ wanted = () => true, found = () => {} } = {}) {
  loadTakesOfClips(wanted, found);
  await settle();
}

/** Answers that come one at a time. */
function answers(t) {
  const waiting = [];
  t.mock.method(globalThis, "fetch", async ({ url }) => {
    await new Promise((go) => waiting.push(go));
    return Response.json([{ start: 1, clip: url }]);
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
  await Promise.all([load({ found: draw }), load({ found: draw })]);
  assert.equal(waiting.length, 4);
  await one();
  assert.equal(waiting.length, 4);
  assert.deepEqual([...takesByClip.keys()], ["a0"]);
  while (waiting.length) await one();
  assert.equal(takesByClip.size, 9);
  assert.equal(drawn, 9);
  await load();
  assert.equal(waiting.length, 0);
});

test("what is on its way is not asked for again when the table is opened again", async (t) => {
  const { waiting, one } = answers(t);
  update({ clips: clips("c", 2) });
  const open = () => {
    forgetFailures();
    return load();
  };
  await Promise.all([open(), open()]);
  assert.equal(waiting.length, 2);
  while (waiting.length) await one();
});

test("no more are asked for once nobody wants them, and the rest at the next time", async (t) => {
  const { waiting, one } = answers(t);
  update({ clips: clips("b", 6) });
  let open = true;
  const wanted = () => open;
  await load({ wanted });
  open = false;
  while (waiting.length) await one();
  assert.equal([...takesByClip.keys()].filter((id) => id.startsWith("b")).length, 4);
  open = true;
  await load({ wanted });
  assert.equal(waiting.length, 2);
  while (waiting.length) await one();
});

test("a clip whose takes the server refuses does not hold up the others", async (t) => {
  const asked = [];
  t.mock.method(globalThis, "fetch", async ({ url }) => {
    asked.push(url);
    // Cancelled is the one error without a toast, which needs a page.
    if (asked.at(-1).includes("d1")) return Response.json({ code: "cancelled" }, { status: 409 });
    return Response.json([]);
  });
  update({ clips: clips("d", 6) });
  await load();
  await until(() => asked.length === 6);
  await load();
  assert.equal(asked.length, 6, "not again while the table is open");
  forgetFailures();
  await load();
  await until(() => asked.length === 7);
  assert.match(asked[6], /d1/);
  await settle();
});

test("without a server nothing more is asked for, and everything once it is back", async (t) => {
  const asked = [];
  let away = true;
  t.mock.method(globalThis, "fetch", async ({ url }) => {
    asked.push(url);
    if (away) throw new TypeError("fetch failed");
    return Response.json([]);
  });
  update({ clips: clips("e", 9) });
  await load();
  await settle();
  assert.equal(asked.length, 4);
  away = false;
  await load();
  await until(() => asked.length === 4 + 9);
});
