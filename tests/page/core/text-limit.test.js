import assert from "node:assert/strict";
import { test } from "node:test";

import { cut } from "../../../static/js/core/text-limit.js";

test("a text is cut by code points, as the server counts them", () => {
  assert.equal(cut("𝒜𝒷𝒸", 3), "𝒜𝒷𝒸");
  assert.equal(cut("🤿🤿🤿", 2), "🤿🤿");
  assert.equal(cut("circle", 6), "circle");
  assert.equal(cut("circles", 6), "circle");
});
