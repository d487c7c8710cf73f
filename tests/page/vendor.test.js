import assert from "node:assert/strict";
import { readdir, readFile } from "node:fs/promises";
import { test } from "node:test";

const KEPT = new URL("../../static/vendor/lit-html/", import.meta.url);
const PACKAGE = new URL("../../node_modules/lit-html/", import.meta.url);

/** Node's build has the same code, but can be imported where there is no document. */
const originOf = (file) => new URL(file.endsWith(".js") ? `node/${file}` : file, PACKAGE);

const entries = await readdir(KEPT, { recursive: true, withFileTypes: true });
const files = entries
  .filter((entry) => entry.isFile())
  .map(({ parentPath, name }) => `${parentPath}/${name}`.split("/static/vendor/lit-html/")[1])
  .map((file) => file.replace(/^\/+/, ""));

test("the kept lit-html is that of the locked package, byte for byte", async () => {
  assert.ok(files.includes("lit-html.js") && files.includes("LICENSE"));
  for (const file of files) {
    const [kept, published] = await Promise.all([
      readFile(new URL(file, KEPT)),
      readFile(originOf(file)),
    ]);
    assert.ok(kept.equals(published), file);
  }
});
