import assert from "node:assert/strict";
import { test } from "node:test";

import { follow, lengthOf, state, update, whenLoaded } from "../../../static/js/core/state.js";

test("what waits for the lists goes on once they are there", async () => {
  let waited = false;
  const waiting = whenLoaded().then(() => (waited = true));
  await Promise.resolve();
  assert.equal(waited, false);
  update({ loaded: true });
  await waiting;
  assert.equal(waited, true);
  update({ loaded: false });
});

test("a listener is called at once, and then only when a value it named changes", () => {
  const seen = [];
  follow(["samples", "loaded"], ({ loaded }) => seen.push(loaded));
  update({ connected: true });
  update({ loaded: true });
  update({ loaded: true });
  assert.deepEqual(seen, [false, true]);
});

test("a listener sees all values of one update together", () => {
  const seen = [];
  follow(["takes"], ({ takes, timeline }) => seen.push([takes, timeline]));
  const [takes, timeline] = [[], { time: [0, 1.5] }];
  update({ takes, timeline });
  assert.deepEqual(seen.at(-1), [takes, timeline]);
});

test("a clip is as long as its last frame says, else its container", () => {
  update({ timeline: { time: [0, 1.5] } });
  assert.equal(lengthOf({ duration: 2 }), 1.5);
  update({ timeline: null });
  assert.equal(lengthOf({ duration: 2 }), 2);
  assert.equal(lengthOf({ duration: null }), 0);
  assert.equal(state.timeline, null);
});
