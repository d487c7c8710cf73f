// Frames and their moments: `time` is when each frame is shown, by the container's clock.

/** A range of fewer frames holds no gesture. */
export const LEAST_FRAMES = 3;

/** The frame that is nearest to a moment. */
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

/** A moment inside a frame, so that a video that is sent there shows that frame and not the one before. */
export const insideFrame = (time, frame) => time[frame] + ((time[frame + 1] ?? time[frame]) - time[frame]) / 2;
