// Frames and their timestamps: `time` has each frame's container timestamp in seconds.

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

/**
 * The time of the first frame by the clock of a video whose source was just set. It is not 0 if
 * sound begins before the picture, or if the file was cut from a longer one.
 *
 * @param {HTMLVideoElement} video
 * @returns {Promise<number>}
 */
export const firstMoment = (video) =>
  new Promise((resolve) => {
    // Firefox before 132 has no such callback.
    if (video.requestVideoFrameCallback)
      video.requestVideoFrameCallback((now, { mediaTime }) => resolve(mediaTime));
    else video.addEventListener("loadeddata", () => resolve(video.currentTime), { once: true });
  });

/**
 * Seek a video to a moment, and draw over it once it shows that frame. Does nothing while a seek is
 * under way: a seek interrupted by the next one shows no frame.
 *
 * @param {HTMLVideoElement} video
 * @param {number} moment
 * @param {() => void} draw
 */
export function drawAt(video, moment, draw) {
  if (video.seeking) return;
  video.onseeked = draw;
  video.currentTime = moment;
}
