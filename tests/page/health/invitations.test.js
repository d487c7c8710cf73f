import assert from "node:assert/strict";
import { test } from "node:test";

import { arrivals, hindrance } from "../../../static/js/health/invitations.js";
import { across, up } from "../../../static/js/health/people-curve.js";

const take = (diver, label, status, reason = null) => ({ diver, label, status, reason });

test("what came in is told by person, with the reason of what was returned", () => {
  assert.deepEqual(arrivals([]), []);
  assert.deepEqual(
    arrivals([
      take("Bo", "circle", "added"),
      take("Cy", "circle", "waiting"),
      take("Bo", "line", "returned", "Hand not seen. Show it again nearer."),
    ]),
    [
      "Bo: circle added, line returned (Hand not seen. Show it again nearer).",
      "Cy: circle is looked at.",
    ],
  );
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
