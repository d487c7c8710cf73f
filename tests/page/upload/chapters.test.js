import assert from "node:assert/strict";
import { test } from "node:test";

import { chaptersAmong } from "../../../static/js/upload/chapters.js";

const files = (...names) =>
  names.map((each) => {
    const [name, size = 100] = [each].flat();
    return { name, size };
  });

const found = (...names) =>
  chaptersAmong(files(...names)).map((run) => run.map(({ name }) => name));

test("a GoPro's chapters share a number, whatever their sizes and order", () => {
  assert.deepEqual(
    found("GX020042.MP4", "GX010042.MP4", "GX010043.MP4", ["GX030042.MP4", 900], "other.mp4"),
    [["GX010042.MP4", "GX020042.MP4", "GX030042.MP4"]],
  );
  assert.deepEqual(found("GP010042.MP4", "GOPR0042.MP4"), [["GOPR0042.MP4", "GP010042.MP4"]]);
  assert.deepEqual(found("GX010042.MP4", "GX030042.MP4"), []);
});

test("consecutive videos of a DJI are chapters where all but the last are as large", () => {
  assert.deepEqual(found("DJI_0001.MP4", "DJI_0002.MP4", ["DJI_0003.MP4", 7]), [
    ["DJI_0001.MP4", "DJI_0002.MP4", "DJI_0003.MP4"],
  ]);
  assert.deepEqual(
    found("DJI_20240101120000_0001_D.MP4", ["DJI_20240101121000_0002_D.MP4", 50]).length,
    1,
  );
  assert.deepEqual(found("DJI_0001.MP4", ["DJI_0002.MP4", 200]), []);
  assert.deepEqual(found("DJI_0001.MP4", "DJI_0003.MP4"), []);
});

test("a file every minute is a chapter, by its time or its number", () => {
  assert.equal(found("dive-0009.ts", "dive-0010.ts").length, 1);
  assert.equal(found("cam_20241231_235900.mp4", "cam_20250101_000000.mp4").length, 1);
});

test("three pieces of one size and a rest are pieces of a recording, whatever their digits", () => {
  for (const ending of ["ts", "mp4", "mkv"]) {
    const pieces = ["00", "01", ["02", 7]].map((each) => {
      const [digits, size = 100] = [each].flat();
      return [`seg_${digits}.${ending}`, size];
    });
    assert.equal(found(...pieces)[0].length, 3);
  }
  assert.deepEqual(found("a-01.mp4", ["a-02.mp4", 300], "a-03.mp4"), []);
});

test("takes of a phone are not", () => {
  assert.deepEqual(found("VID_20240101_120000.mp4", "VID_20240101_120017.mp4"), []);
  assert.deepEqual(found("take-0001.mp4", "take-0002.mp4", "IMG_0001.MOV", "IMG_0002.MOV"), []);
});
