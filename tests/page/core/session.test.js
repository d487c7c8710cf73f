import assert from "node:assert/strict";
import { test } from "node:test";

globalThis.addEventListener ??= () => {};
const { describeSession, mayWrite } = await import("../../../static/js/core/session.js");
const { state } = await import("../../../static/js/core/state.js");

test("who is signed in is named with the role", () => {
  assert.equal(describeSession({ name: "Ada", role: "read" }), "Signed in as Ada (read)");
});

test("a server without tokens names nobody", () => {
  assert.equal(describeSession({ name: "", role: "admin" }), "");
});

test("all but readers may change what others see", () => {
  const may = ["read", "edit", "admin", null].map((role) => {
    state.role = role;
    return mayWrite();
  });
  assert.deepEqual(may, [false, true, true, true]);
});
