import assert from "node:assert/strict";
import { test } from "node:test";

import { mayGoOn, metadataOf, standOf } from "../../../static/js/upload/tus-upload.js";

const decoded = (metadata) =>
  Object.fromEntries(
    metadata.split(",").map((entry) => {
      const [name, text] = entry.split(" ");
      return [name, Buffer.from(text, "base64").toString("utf8")];
    }),
  );

test("a file's name and fields are sent as base64 of UTF-8", () => {
  const fields = { frame_rate: "29.97", topic: "/camera/image" };
  assert.deepEqual(decoded(metadataOf("Gruß, Taucher ✓.mp4", fields)), {
    filename: "Gruß, Taucher ✓.mp4",
    ...fields,
  });
});

test("an upload stands where the server says, and is a clip once it has an address", () => {
  const headers = new Headers({ "Upload-Offset": "8388608" });
  assert.deepEqual(standOf("/u/1", headers), { place: "/u/1", offset: 8388608, clip: null });
  headers.set("Content-Location", "/api/v1/clips/abc");
  assert.equal(standOf("/u/1", headers).clip, "abc");
});

test("an upload goes on after a break, and not after a refusal", () => {
  const errors = [{ code: "offline" }, { status: 503 }, { status: 409, code: "upload_offset" }];
  assert.deepEqual(errors.map(mayGoOn), [true, true, true]);
  assert.deepEqual([{ status: 413 }, { status: 415, code: "unknown_media" }].map(mayGoOn), [
    false,
    false,
  ]);
});
