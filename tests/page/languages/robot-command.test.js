import assert from "node:assert/strict";
import { test } from "node:test";

import { read, written } from "../../../static/js/languages/robot-command.js";

test("a command that is written and read again is the same", () => {
  for (const command of [null, "follow me", { do: "ascend", metres: 2 }]) {
    assert.deepEqual(read(written(command)).command, command);
  }
});

test("a broken object never reaches the robot as words", () => {
  assert.match(read('{"do": "ascend"').problem, /JSON object/);
  assert.match(read("[1, 2]").problem, /is an object/);
});
