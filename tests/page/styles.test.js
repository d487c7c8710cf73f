import assert from "node:assert/strict";
import { readdir, readFile } from "node:fs/promises";
import { test } from "node:test";

const STATIC = new URL("../../static/", import.meta.url);
const COLOUR = /#(?:[0-9a-f]{8}|[0-9a-f]{6}|[0-9a-f]{3,4})\b(?=[\s;,)"'`])|\b(?:rgba?|hsla?)\(/gi;

const read = (path) => readFile(new URL(path, STATIC), "utf8");

async function filesIn(folder, suffix) {
  const files = await readdir(new URL(folder, STATIC), { recursive: true });
  return files.filter((file) => file.endsWith(suffix)).map((file) => `${folder}${file}`);
}

const sheets = await filesIn("styles/", ".css");
const recognitionPage = [
  ...(await filesIn("recognition-page/", ".css")),
  ...(await filesIn("recognition-page/", ".js")),
  ...(await filesIn("invitation-page/", ".css")),
];

test("only tokens.css has colours", async () => {
  const others = [...sheets, ...recognitionPage, ...(await filesIn("js/", ".js"))];
  for (const file of others.filter((each) => each !== "styles/tokens.css")) {
    assert.deepEqual((await read(file)).match(COLOUR), null, file);
  }
  assert.ok((await read("styles/tokens.css")).match(COLOUR).length > 20);
});

test("every custom property that is used is defined, and the page loads every sheet", async () => {
  const sources = [...sheets, ...recognitionPage, ...(await filesIn("js/", ".js"))];
  const text = (await Promise.all(sources.map(read))).join("\n");
  const defined = new Set([...text.matchAll(/["`\s{](--[\w-]+)"?:/g)].map(([, name]) => name));
  const used = new Set([...text.matchAll(/var\((--[\w-]+)/g)].map(([, name]) => name));
  assert.deepEqual(
    [...used].filter((name) => !defined.has(name)),
    [],
  );
  const index = await read("index.html");
  for (const sheet of sheets) {
    assert.ok(index.includes(`static/${sheet}`), sheet);
    assert.doesNotMatch(await read(sheet), /@import|@charset/, "the server joins the sheets");
  }
});

test("margins, paddings and gaps are steps of the one scale", async () => {
  const SPACING =
    /(?:^|[\s;{])((?:scroll-)?(?:margin|padding)[\w-]*|(?:row-|column-)?gap):([^;}]+)/g;
  // A negative pixel lets two borders lie on each other.
  const raw = (value) =>
    /(?<![\w.])\d*\.?\d+(?:px|r?em|ch|pt)\b/.test(value.replace(/-1px\b/g, ""));
  for (const file of [...sheets, ...recognitionPage.filter((each) => each.endsWith(".css"))]) {
    const found = [...(await read(file)).matchAll(SPACING)].filter(([, , value]) => raw(value));
    assert.deepEqual(
      found.map(([declaration]) => declaration.trim()),
      [],
      file,
    );
  }
  const steps = (await read("styles/tokens.css")).match(/--space-\d+:/g);
  assert.ok(steps.length <= 12, `${steps.length} steps`);
});
