import assert from "node:assert/strict";
import { readdir, readFile } from "node:fs/promises";
import { test } from "node:test";

import { cut } from "../../../static/js/core/text-limit.js";

const STATIC = new URL("../../../static/", import.meta.url);

test("a text is cut by code points, as the server counts them", () => {
  assert.equal(cut("𝒜𝒷𝒸", 3), "𝒜𝒷𝒸");
  assert.equal(cut("🤿🤿🤿", 2), "🤿🤿");
  assert.equal(cut("circle", 6), "circle");
  assert.equal(cut("circles", 6), "circle");
});

test("no field is limited by UTF-16 units, of which an emoji has two", async () => {
  const files = await readdir(STATIC, { recursive: true });
  for (const file of files.filter((each) => /\.(js|html)$/.test(each))) {
    const text = await readFile(new URL(file, STATIC), "utf8");
    assert.doesNotMatch(text.replace(/^\/\/.*$/gm, ""), /maxlength/i, file);
  }
});
