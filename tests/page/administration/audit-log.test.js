import assert from "node:assert/strict";
import { test } from "node:test";

import { queryOf } from "../../../static/js/administration/audit-log.js";

test("both days of a filter count whole", () => {
  const query = queryOf({ name: " Eve ", from: "2026-11-24", to: "2026-11-24" }, 7);
  assert.deepEqual([query.name, query.before], ["Eve", "7"]);
  assert.equal(query.since, new Date("2026-11-24T00:00").toISOString());
  assert.equal(query.until, new Date("2026-11-25T00:00").toISOString());
  assert.deepEqual(Object.keys(queryOf({ name: "", from: "", to: "" })), ["limit"]);
});
