// Frames and their timestamps: `time` has each frame's container timestamp in seconds.

const HAVE_METADATA = 1; // HTMLMediaElement's, which no test outside a browser has

/** The fewest frames of a range. */
export const LEAST_FRAMES = 3;

/**
 * The frame that is nearest to a moment.
 *
 * @param {number[]} time
 * @param {number} seconds
 * @returns {number}
 */
export function nearestFrame(time, seconds) {
  let low = 0;
  let high = time.length - 1;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (time[middle] < seconds) low = middle + 1;
    else high = middle;
  }
  return low > 0 && seconds - time[low - 1] < time[low] - seconds ? low - 1 : low;
}

/**
 * A moment in the middle of a frame, so that a video seeking there shows this frame and not the one
 * before. The last frame, whose duration is unknown, counts as long as the one before it.
 *
 * @param {number[]} time
 * @param {number} frame
 */
export const insideFrame = (time, frame) =>
  time[frame] +
  (time[frame + 1] === undefined
    ? time[frame] - (time[frame - 1] ?? time[frame])
    : time[frame + 1] - time[frame]) /
    2;

const ROUNDING = 0.001; // s: containers round their timestamps
const SLOWEST = 1 / 16; // of the usual speed: the least at which browsers play
const LEAD = 0.004; // s: how long before a frame playing begins; no camera's frame is as short
const MOST_SEEKS = 3; // until a frame counts as missing in the video

/**
 * A frame to show: when it begins, and a moment inside it to seek to, in seconds of the clip.
 * `shown` is called once it is on the screen.
 *
 * @typedef {{ begin: number, inside?: number, shown?: () => void }} Frame
 */

/**
 * Show single frames of a video: `load(source)` its file, then `show(frame)` any number of times.
 * The next frame does not cut a seek short, or none would be shown; the newest one comes next.
 *
 * After a seek Chromium may show an earlier frame: an MP4 whose frames are stored out of order has
 * wrong durations, by which a frame lasts beyond the beginning of the next. Playing goes by the
 * frames' beginnings, so the video plays slowly until the wanted frame is on the screen.
 *
 * @param {HTMLVideoElement} video
 */
export function showFrames(video) {
  /** @type {number | null} */
  let start = null; // of the clip by the video's clock: not 0 if sound begins before the picture
  /** @type {number | null} */
  let onScreen = null; // when the frame on the screen begins, in seconds of the clip; null: unknown
  /** @type {Frame | null} */
  let sought = null;
  /** @type {Frame | null} */
  let newest = null; // the frame to seek to as soon as the last one is done
  let done = true; // whether the frame sought is shown, or counts as missing
  let seeks = 0; // so far for the frame sought: once into it, then before it to play

  video.defaultPlaybackRate = SLOWEST;
  if (video.requestVideoFrameCallback) video.requestVideoFrameCallback(follow);
  // Firefox before 132 has no such callback: there nobody knows which frame a seek shows.
  else video.onloadeddata = () => presented(video.currentTime);
  video.onseeked = () => {
    if (!video.requestVideoFrameCallback && sought) onScreen = sought.begin;
    settle();
  };

  /**
   * @param {number} now
   * @param {{ mediaTime: number }} frame
   */
  function follow(now, { mediaTime }) {
    video.requestVideoFrameCallback(follow); // first: after a seek Chromium may miss its frame
    // A frame of the clip before may come after another one was chosen.
    if (video.readyState >= HAVE_METADATA) presented(mediaTime);
  }
  /** @param {number} moment of the video's clock */
  function presented(moment) {
    start ??= moment;
    onScreen = moment - start;
    if (done) showNewest();
    settle();
  }
  function showNewest() {
    if (!newest || start === null) return;
    [sought, newest, done, seeks] = [newest, null, false, 0];
    if (isShown(sought)) settle();
    else seek(sought);
  }
  /** @param {Frame} frame that begins on the screen, or, in Firefox, at the moment sought */
  const isShown = ({ begin, inside = begin }) =>
    onScreen !== null && onScreen > begin - ROUNDING && onScreen < inside + 2 * ROUNDING;

  /** @param {Frame} frame */
  function seek({ begin, inside = begin + ROUNDING }) {
    const moment = (start ?? 0) + (seeks ? begin - LEAD : inside);
    seeks += 1;
    if (video.currentTime !== moment) onScreen = null; // Otherwise no new frame may come.
    video.currentTime = moment;
  }
  /** Look whether the frame sought is on the screen, also after it was: playing may pass it by. */
  function settle() {
    if (!sought || onScreen === null || video.seeking) return;
    if (isShown(sought) || seeks > MOST_SEEKS) finish(sought);
    else if (onScreen < sought.begin && seeks > 1 && !video.ended) play(sought);
    else {
      video.pause();
      seek(sought);
    }
  }
  /** @param {Frame} frame */
  function play(frame) {
    if (!video.paused) return;
    video.play().catch(({ name }) => {
      // A browser that saves power plays nothing unasked. A pause has another name.
      if (name === "NotAllowedError" && sought === frame) finish(frame);
    });
  }
  /** @param {Frame} frame */
  function finish(frame) {
    video.pause();
    if (!done && isShown(frame)) frame.shown?.();
    done = true;
    showNewest();
  }

  return {
    /** @param {string} source */
    load(source) {
      [start, onScreen, sought, newest, done] = [null, null, null, null, true];
      video.src = source;
    },
    /** @param {Frame} frame */
    show(frame) {
      newest = frame;
      if (done) showNewest();
    },
  };
}
