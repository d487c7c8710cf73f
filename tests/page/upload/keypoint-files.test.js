import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { test } from "node:test";

import { kindOfJson } from "../../../static/js/upload/keypoint-files.js";

const kind = (text) => kindOfJson(new Blob([text]));

test("a language of the repository is a language", async () => {
  const file = new URL("../../../languages/osg-table-1.json", import.meta.url);
  assert.equal(await kind(await readFile(file, "utf8")), "language");
});

test("the published format is a language too", async () => {
  assert.equal(await kind('{"circle": {"image": [[0]], "salient_keypoints": []}}'), "language");
});

test("lists of frames are keypoints, one frame of OpenPose is a frame", async () => {
  assert.equal(await kind('[{"keypoints": []}]'), "keypoints");
  assert.equal(await kind('{"meta": {"fps": 30}, "frames": []}'), "keypoints");
  assert.equal(await kind('{"meta_info": {"a": [1]}, "instance_info": [{}]}'), "keypoints");
  assert.equal(await kind('{"info": {}, "images": [], "annotations": []}'), "keypoints");
  assert.equal(await kind('{"version": 1.3, "people": []}'), "frame");
});
