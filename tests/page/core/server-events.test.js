import assert from "node:assert/strict";
import { test } from "node:test";

import "../relative-requests.js";

/** A browser's event source, opened and broken by the test. */
class Stream extends EventTarget {
  static all = [];
  static CLOSED = 2;
  readyState = 0;

  constructor() {
    super();
    Stream.all.push(this);
  }

  close() {
    this.readyState = Stream.CLOSED;
  }
}

globalThis.addEventListener ??= () => {};
globalThis.location ??= { search: "", pathname: "/" };
globalThis.EventSource = Stream;
const page = Object.assign(new EventTarget(), { hidden: false });
globalThis.document = page;
const { followServer } = await import("../../../static/js/core/server-events.js");
const { state, update } = await import("../../../static/js/core/state.js");

let status = 502;
globalThis.fetch = async () => new Response("{}", { status });

/** Wait until all requests are answered. */
const answered = () => new Promise((resolve) => setImmediate(resolve));

/** The page is looked at, or no more. */
function look(hidden) {
  page.hidden = hidden;
  page.dispatchEvent(new Event("visibilitychange"));
}

test("a page that nobody looks at gives its connection back, and catches up once it is seen", async (t) => {
  t.mock.timers.enable({ apis: ["setTimeout"] });
  const heard = [];
  const names = ["opened", "returned", "seen", "clips", "languages", "jobs"];
  followServer(Object.fromEntries(names.map((name) => [name, (what) => heard.push([name, what])])));
  const [first] = Stream.all;
  first.onopen();
  assert.deepEqual(heard.splice(0), [["opened", undefined]]);

  look(true);
  t.mock.timers.tick(10_000);
  look(false);
  t.mock.timers.tick(60_000);
  assert.equal(first.readyState, 0, "a short look elsewhere changes nothing");
  first.dispatchEvent(new MessageEvent("clips", { data: '{"id": "c1"}' }));
  assert.deepEqual(heard.splice(0), [["clips", "c1"]]);
  const job = { id: "j1", clip_id: "c1", status: "running" };
  first.dispatchEvent(new MessageEvent("jobs", { data: JSON.stringify(job) }));
  assert.deepEqual(heard.splice(0), [["jobs", job]]);
  const deleted = '{"id": "j1", "clip_id": "c1", "progress": {"time": 0.2}}';
  first.dispatchEvent(new MessageEvent("jobs", { data: deleted }));
  assert.deepEqual(heard.splice(0), [["clips", "c1"]], "a job is gone with its clip");

  update({ pending: [{ clip: "c1" }] });
  look(true);
  t.mock.timers.tick(60_000);
  assert.equal(first.readyState, 0, "clips are tested in the background too");
  update({ pending: [] });
  t.mock.timers.tick(60_000);
  assert.equal(first.readyState, Stream.CLOSED);
  assert.equal(Stream.all.length, 1);
  assert.equal(state.connected, true, "nothing is lost");

  assert.equal(heard.length, 0);

  const { returns } = state;
  look(false);
  const second = Stream.all[1];
  second.onopen();
  assert.deepEqual(heard.splice(0), [
    ["opened", undefined],
    ["seen", undefined],
  ]);
  assert.equal(state.returns, returns + 1);

  second.readyState = Stream.CLOSED;
  second.onerror();
  assert.equal(state.connected, false);
  t.mock.timers.tick(5_000);
  await answered();
  Stream.all[2].onopen();
  assert.deepEqual(
    heard.map(([name]) => name),
    ["opened", "returned"],
  );
  assert.equal(state.connected, true);
});

test("a page whose session has ended goes to the page to sign in, and asks no more", async (t) => {
  t.mock.timers.enable({ apis: ["setTimeout"] });
  const opened = [];
  globalThis.location.assign = (address) => opened.push(address);
  const stream = Stream.all.at(-1);
  const { length } = Stream.all;
  status = 401;
  stream.readyState = Stream.CLOSED;
  stream.onerror();
  t.mock.timers.tick(5_000);
  await answered();
  assert.deepEqual(opened, ["./"]);
  assert.equal(Stream.all.length, length);
});
