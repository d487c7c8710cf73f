import assert from "node:assert/strict";
import { test } from "node:test";

import { isMirrored } from "../../../static/js/camera/mirror.js";

const camera = (settings) => ({ getVideoTracks: () => [{ getSettings: () => settings }] });

test("a camera that faces the diver is a mirror, and one that does not say where it looks", () => {
  assert.ok(isMirrored(camera({ facingMode: "user" })));
  assert.ok(isMirrored(camera({ deviceId: "webcam" })));
});

test("a phone's rear camera and a clip are shown as they are", () => {
  assert.ok(!isMirrored(camera({ facingMode: "environment" })));
  assert.ok(!isMirrored(null));
});
