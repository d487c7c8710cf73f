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
 * A moment inside a frame, so that a video that is sent there shows that frame and not the one
 * before. Of the last frame nobody knows how long it stands: as long as the one before it.
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
 * When a video whose source was just set shows its first frame, by its own clock. That is not 0
 * where sound begins before the picture, or where the file was cut out of a longer one.
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
 * Send a video to a moment, and draw over it once it shows that moment's frame. While a seek is
 * under way nothing is done: a seek that is cut short by the next shows nothing.
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
