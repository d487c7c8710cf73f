import assert from "node:assert/strict";
import { test } from "node:test";

import { anglesInWords } from "../../../static/js/health/angle-plot.js";

const missed = (rate) => ({ rate, low: rate, high: rate });

test("every angle is told with its side, its rate and what it is read as", () => {
  assert.equal(
    anglesInWords([
      { degrees: -30, missed: missed(0.02), read_as: null },
      { degrees: 60, missed: missed(0.7), read_as: "wave" },
    ]),
    "30\u00b0 right: missed in 2 %\n60\u00b0 left: missed in 70 %, read as wave",
  );
});
