import assert from "node:assert/strict";
import { afterEach, test } from "node:test";

import { browserStore, tabStore } from "../../../static/js/core/browser-store.js";

const refuse = () => {
  throw new Error("refused");
};

/** @param {PropertyDescriptor} descriptor of the browser's store */
const site = (descriptor) =>
  Object.defineProperty(globalThis, "localStorage", { configurable: true, ...descriptor });

/** @param {Map<string, string>} map */
const storage = (map) => ({
  getItem: (key) => map.get(key) ?? null,
  setItem: (key, text) => map.set(key, text),
  removeItem: (key) => map.delete(key),
});

afterEach(() => site({ value: undefined }));

test("what the browser keeps is read by the next visit", () => {
  const kept = new Map();
  site({ value: storage(kept) });
  browserStore.set("look", "sun");
  assert.equal(kept.get("look"), "sun");
  browserStore.set("look", null);
  assert.equal(kept.size, 0);
});

const unkind = {
  refused: { get: refuse },
  absent: { value: null },
  full: { value: { ...storage(new Map([["full", '"old"']])), setItem: refuse } },
};

for (const [name, descriptor] of Object.entries(unkind))
  test(`what a store that is ${name} does not take is kept for the visit`, () => {
    site(descriptor);
    assert.equal(browserStore.read(`none ${name}`), null);
    browserStore.write(name, { takes: 2 });
    assert.deepEqual(browserStore.read(name), { takes: 2 });
    browserStore.set(name, null);
    assert.equal(browserStore.get(name), null);
    assert.equal(tabStore.get(name), null);
  });

test("a damaged value is none", () => {
  site({ value: storage(new Map([["damaged", "{"]])) });
  assert.equal(browserStore.read("damaged"), null);
});
