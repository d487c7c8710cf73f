import assert from "node:assert/strict";
import { test } from "node:test";

import { drawAt, insideFrame, nearestFrame } from "../../../static/js/clips/frame-times.js";

const TIME = [0, 0.04, 0.08, 0.2, 0.24]; // a pause of the camera between the third and the fourth

test("the nearest frame of every frame's own moment is that frame", () => {
  assert.deepEqual(
    TIME.map((seconds) => nearestFrame(TIME, seconds)),
    [0, 1, 2, 3, 4],
  );
});

test("moments outside a clip belong to its first and last frame", () => {
  assert.deepEqual([nearestFrame(TIME, -1), nearestFrame(TIME, 99)], [0, 4]);
});

test("a moment between two frames belongs to the nearer one", () => {
  assert.deepEqual(
    [0.11, 0.15].map((seconds) => nearestFrame(TIME, seconds)),
    [2, 3],
  );
});

test("a moment inside a frame lies between it and the next", () => {
  TIME.slice(0, -1).forEach((seconds, frame) => {
    const inside = insideFrame(TIME, frame);
    assert.ok(seconds < inside && inside < TIME[frame + 1]);
  });
});

test("the last frame lasts as long as the one before it", () => {
  assert.equal(insideFrame(TIME, 4).toFixed(3), "0.260");
  assert.equal(insideFrame([0], 0), 0);
});

/** A video as far as seeking goes: under way until `arrive`, and cut short by each new one. */
class SeekingVideo {
  seeking = false;
  onseeked = () => {};
  #moment = 0;

  get currentTime() {
    return this.#moment;
  }

  set currentTime(moment) {
    this.#moment = moment;
    this.seeking = true;
  }

  arrive() {
    this.seeking = false;
    this.onseeked();
  }
}

test("a pose is drawn once the video shows its frame, not before", () => {
  const [video, drawn] = [new SeekingVideo(), []];
  drawAt(video, 1.5, () => drawn.push("pose"));
  assert.equal(video.currentTime, 1.5);
  assert.deepEqual(drawn, []);
  video.arrive();
  assert.deepEqual(drawn, ["pose"]);
});

test("a pose that comes while the video still seeks neither cuts the seek short nor is drawn", () => {
  const [video, drawn] = [new SeekingVideo(), []];
  drawAt(video, 1, () => drawn.push("first"));
  drawAt(video, 2, () => drawn.push("second"));
  assert.equal(video.currentTime, 1);
  video.arrive();
  assert.deepEqual(drawn, ["first"]);
  drawAt(video, 3, () => drawn.push("third"));
  video.arrive();
  assert.deepEqual(drawn, ["first", "third"]);
});
