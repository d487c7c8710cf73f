import assert from "node:assert/strict";
import { readdir, readFile } from "node:fs/promises";
import { test } from "node:test";

const VENDOR = new URL("../../static/vendor/", import.meta.url);
const PACKAGES = new URL("../../node_modules/", import.meta.url);

/**
 * Where each package publishes the files that the page keeps. Node's build of lit-html has the same
 * code, but can be imported where there is no document.
 */
const ORIGINS = {
  "lit-html": (file) => (file.endsWith(".js") ? `node/${file}` : file),
  "openapi-fetch": (file) => (file === "LICENSE" ? file : `dist/${file}`),
};

const entries = await readdir(VENDOR, { recursive: true, withFileTypes: true });
const files = entries
  .filter((entry) => entry.isFile())
  .map(({ parentPath, name }) => `${parentPath}/${name}`.split("/static/vendor/")[1])
  .map((file) => file.replace(/^\/+/, ""));

test("no library is kept that is not compared with its locked package", () => {
  const kept = new Set(files.map((file) => file.split("/")[0]));
  assert.deepEqual([...kept].sort(), Object.keys(ORIGINS));
});

for (const [library, originOf] of Object.entries(ORIGINS))
  test(`the kept ${library} is that of the locked package, byte for byte`, async () => {
    const kept = files.filter((file) => file.startsWith(`${library}/`));
    assert.ok(kept.includes(`${library}/LICENSE`));
    for (const file of kept) {
      const origin = `${library}/${originOf(file.slice(library.length + 1))}`;
      const [here, published] = await Promise.all([
        readFile(new URL(file, VENDOR)),
        readFile(new URL(origin, PACKAGES)),
      ]);
      assert.ok(here.equals(published), file);
    }
  });
