import assert from "node:assert/strict";
import { test } from "node:test";

import { state } from "../../../static/js/core/state.js";
import { showNewest } from "../../../static/js/languages/language-store.js";

const language = (id, revision) => ({ id, revision, gestures: [] });

test("an older answer that comes last does not replace a newer revision", () => {
  showNewest(language("pool", 2));
  showNewest(language("pool", 3));
  showNewest(language("pool", 2));
  assert.equal(state.gestures.revision, 3);
  showNewest(language("lake", 1));
  assert.equal(state.gestures.id, "lake");
});
