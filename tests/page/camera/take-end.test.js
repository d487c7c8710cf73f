import assert from "node:assert/strict";
import { test } from "node:test";

import { takeEnd } from "../../../static/js/camera/take-end.js";

test("a take is over once its closing trigger is let go, and not before", () => {
  let count = 0;
  const end = takeEnd(() => {
    count += 1;
  });
  for (const state of ["idle", "recording", "done", "done"]) end.seen({ state });
  assert.equal(count, 0);
  end.seen({ state: "idle" });
  assert.equal(count, 1);
  end.seen({ state: "done" });
  end.reset();
  end.seen({ state: "idle" });
  assert.equal(count, 1);
});

test("without a held trigger a take is over a moment after it was recognised", (context) => {
  context.mock.timers.enable({ apis: ["setTimeout"] });
  let count = 0;
  const end = takeEnd(() => {
    count += 1;
  });
  end.recognized({ closed: true }, "salute");
  end.recognized({ closed: false }, "none");
  context.mock.timers.tick(5000);
  assert.equal(count, 0);
  end.recognized({ closed: true }, "gesture");
  end.recognized({ closed: true }, "gesture");
  context.mock.timers.tick(999);
  assert.equal(count, 0);
  context.mock.timers.tick(1);
  assert.equal(count, 1);
});

test("a held trigger ends a take also where the look at its end was left out", () => {
  let count = 0;
  const end = takeEnd(() => {
    count += 1;
  });
  end.recognized({ closed: true }, "salute");
  end.seen({ state: "done" });
  assert.equal(count, 0);
  end.recognized({ closed: true }, "salute");
  end.seen({ state: "idle" });
  assert.equal(count, 1);
});
