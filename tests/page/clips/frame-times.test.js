import assert from "node:assert/strict";
import { test } from "node:test";

import { insideFrame, nearestFrame, showFrames } from "../../../static/js/clips/frame-times.js";

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

/**
 * A video as far as single frames go: a seek is under way until `arrive`. By the file, one frame
 * lasts longer than it should, which Chromium believes after a seek, and not when it plays.
 */
class SeekingVideo {
  #moment = 0;
  paused = true;
  seeking = false;
  ended = false;
  readyState = 0;
  seeks = [];
  onseeked = () => {};

  constructor(longest) {
    this.longest = longest;
  }

  requestVideoFrameCallback(follow) {
    this.follow = follow;
  }

  get currentTime() {
    return this.#moment;
  }

  set currentTime(moment) {
    this.#moment = moment;
    this.seeking = true;
    this.seeks.push(moment);
  }

  present(mediaTime) {
    this.readyState = 2;
    this.follow(0, { mediaTime });
  }

  arrive() {
    this.seeking = false;
    const believed = TIME.findIndex(
      (begin, frame) =>
        this.#moment - START < (frame === this.longest ? begin + 1 : (TIME[frame + 1] ?? Infinity)),
    );
    this.onseeked();
    this.present(START + TIME[believed]);
  }

  play() {
    this.paused = false;
    return Promise.resolve();
  }

  pause() {
    this.paused = true;
  }
}

const START = 1.4; // s: of the clip, by the video's clock

/** Load a clip whose frame `longest` lasts too long, and note the frames shown. */
function loaded(longest) {
  const [video, shown] = [new SeekingVideo(longest), []];
  const frames = showFrames(video);
  frames.load("clip.mp4");
  video.present(START);
  const show = (frame) =>
    frames.show({
      begin: TIME[frame],
      inside: insideFrame(TIME, frame),
      shown: () => shown.push(frame),
    });
  return { video, shown, show, frames };
}

test("a frame counts as shown once the video presents it, not before", () => {
  const { video, shown, show } = loaded();
  show(2);
  assert.deepEqual(shown, []);
  video.arrive();
  assert.deepEqual(shown, [2]);
});

test("a frame on the screen is shown without a seek", () => {
  const { video, shown, show } = loaded();
  show(0);
  assert.deepEqual([shown, video.seeks], [[0], []]);
});

test("a frame wanted during a seek does not cut it short; the newest comes next", () => {
  const { video, shown, show } = loaded();
  show(1);
  show(2);
  show(3);
  assert.equal(video.seeks.length, 1);
  video.arrive();
  video.arrive();
  assert.deepEqual(shown, [1, 3]);
});

test("where a seek shows an earlier frame, the video plays until the wanted one", () => {
  const { video, shown, show } = loaded(1);
  show(2);
  video.arrive(); // shows frame 1
  video.arrive(); // and again, just before the wanted frame
  assert.deepEqual([shown, video.paused], [[], false]);
  video.present(START + TIME[2]);
  assert.deepEqual([shown, video.paused], [[2], true]);
});

test("a frame passed by while the video plays is sought again", () => {
  const { video, shown, show } = loaded(1);
  show(2);
  video.arrive();
  video.arrive();
  video.present(START + TIME[3]);
  assert.deepEqual([shown, video.paused, video.seeking], [[], true, true]);
});

test("a frame that the video lacks is given up, and the next one is shown", () => {
  const { video, shown, show, frames } = loaded();
  frames.show({ begin: 0.15, shown: () => shown.push("lacking") });
  show(4);
  for (let tries = 0; tries < 20 && !shown.length; tries += 1) {
    if (video.seeking) video.arrive();
    else video.present(START + TIME[3]);
  }
  assert.deepEqual(shown, [4]);
});

test("another clip's frames wait for its first picture", () => {
  const { video, shown, show, frames } = loaded();
  video.readyState = 0;
  frames.load("other.mp4");
  show(0);
  video.follow(0, { mediaTime: 9 }); // still the clip before
  assert.deepEqual(shown, []);
  video.present(START);
  assert.deepEqual(shown, [0]);
});
