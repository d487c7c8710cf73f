import assert from "node:assert/strict";
import { test } from "node:test";

import "../relative-requests.js";
import {
  countAll,
  isListed,
  loadOlder,
  merged,
  reloadClips,
  searchClips,
} from "../../../static/js/clips/clip-pages.js";
import { state, update } from "../../../static/js/core/state.js";

const clip = (number, status = "done") => ({
  id: `c${number}`,
  created: `2026-01-01T00:00:0${number}`,
  status,
});
const ids = (clips) => clips.map(({ id }) => id);

/** A gate at which answers wait while it is shut. */
function gate() {
  let shut = false;
  const waiting = [];
  return {
    shut() {
      shut = true;
    },
    async pass() {
      if (shut) await new Promise((go) => waiting.push(go));
    },
    open() {
      shut = false;
      waiting.splice(0).forEach((go) => go());
    },
  };
}

test("clips are kept once, newest first, as they were loaded last", () => {
  const known = merged([clip(1), clip(3, "queued")], [clip(2), clip(3, "done")]);
  assert.deepEqual(ids(known), ["c3", "c2", "c1"]);
  assert.equal(known[0].status, "done");
});

test("a clip beyond those that are known without gaps is not listed, and counted once", () => {
  const known = { clips: [clip(5), clip(4), clip(1)], library: { last: clip(4), older: 3 } };
  assert.deepEqual(ids(known.clips.filter((each) => isListed(each, known))), ["c5", "c4"]);
  assert.equal(countAll(known), 5);
  const all = { ...known, library: { last: null, older: 0 } };
  assert.equal(countAll(all), 3);
});

test("older clips that are asked for while the list loads anew are not undone by it", async (t) => {
  const lists = gate();
  t.mock.method(globalThis, "fetch", async ({ url }) => {
    const { searchParams } = new URL(url);
    const page = searchParams.get("after") ? [clip(1)] : searchParams.get("status") ? [] : [3, 2];
    const clips = page.map((each) => (typeof each === "number" ? clip(each) : each));
    const older = clips.length === 2 ? { Link: "<older>" } : {};
    if (clips.length === 2) await lists.pass();
    return Response.json(clips, { headers: { "X-Total-Count": "3", ...older } });
  });
  await reloadClips();
  assert.deepEqual(ids(state.clips), ["c3", "c2"]);
  lists.shut();
  const both = Promise.all([reloadClips(), loadOlder()]);
  await new Promise(setImmediate);
  lists.open();
  await both;
  assert.deepEqual(ids(state.clips), ["c3", "c2", "c1"]);
  assert.deepEqual(state.library, { last: null, older: 0 });
});

test("clips that are found while the list loads anew stay known, and at the next time too", async (t) => {
  const lists = gate();
  t.mock.method(globalThis, "fetch", async ({ url }) => {
    const { searchParams } = new URL(url);
    const list = !["q", "id", "status"].some((name) => searchParams.has(name));
    if (list) await lists.pass();
    const clips = list
      ? [clip(3), clip(2)]
      : searchParams.get("q") === "one" || searchParams.getAll("id").includes("c1")
        ? [clip(1)]
        : [];
    const older = list ? { Link: "<older>" } : {};
    return Response.json(clips, { headers: { "X-Total-Count": "3", ...older } });
  });
  update({ clips: [], library: { last: null, older: 0 } });
  await reloadClips();
  lists.shut();
  const both = Promise.all([reloadClips(), searchClips("one")]);
  await new Promise(setImmediate);
  lists.open();
  await both;
  assert.deepEqual(ids(state.clips), ["c3", "c2", "c1"]);
  await reloadClips();
  assert.deepEqual(ids(state.clips), ["c3", "c2", "c1"]);
  await searchClips("none");
  await reloadClips();
  assert.deepEqual(ids(state.clips), ["c3", "c2"]);
});
