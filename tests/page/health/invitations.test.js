import assert from "node:assert/strict";
import { test } from "node:test";

import { forecast, hindrance, outcome } from "../../../static/js/health/invitations.js";
import { across, up } from "../../../static/js/health/people-curve.js";

test("what became of a take is told, with its reason, and who has to answer", () => {
  const told = (status, reason = null) => outcome({ diver: "Bo", status, reason });
  assert.equal(told("added"), "added");
  assert.equal(told("waiting"), "is looked at");
  assert.equal(told("returned", "Hand not seen."), "returned: Hand not seen.");
  assert.equal(told("asked", "Is it 'three'?"), "Bo is asked: Is it 'three'?");
  assert.equal(told("waiting", "It is read as 'line'."), "Waits for you. It is read as 'line'.");
});

test("what a take changes is told where there are takes that tell it", () => {
  assert.match(forecast({ known: 38, repaired: 1, broken: 5 }), /38 known takes .* 1 and breaks 5/);
  assert.match(forecast({ known: 0, repaired: 0, broken: 0 }), /^No take/);
});

test("an address that phones do not reach is named, and one without https", () => {
  assert.match(hindrance("http://127.0.0.1:8000/invitation#x"), /Phones do not reach/);
  assert.match(hindrance("http://[::1]:8000/invitation#x"), /Phones do not reach/);
  assert.match(hindrance("http://192.168.1.5:8000/invitation#x"), /Over http/);
  assert.equal(hindrance("https://boat.example/invitation#x"), "");
});

test("a larger share stands higher in the curve, and more people stand further right", () => {
  assert.ok(up(1) < up(0.5) && up(0.5) < up(0));
  assert.ok(across(1) < across(2) && across(2) < across(7));
});
