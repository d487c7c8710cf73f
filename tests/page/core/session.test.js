import assert from "node:assert/strict";
import { test } from "node:test";

globalThis.addEventListener ??= () => {};
const { describeSession } = await import("../../../static/js/core/session.js");

test("who is signed in is named with the role", () => {
  assert.equal(describeSession({ name: "Ada", role: "read" }), "Signed in as Ada (read)");
});

test("a server without tokens names nobody", () => {
  assert.equal(describeSession({ name: "", role: "admin" }), "");
});
