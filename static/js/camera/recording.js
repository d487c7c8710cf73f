// A clip from the camera: a countdown, the recording, and the file that it becomes.

// In order of preference: the first type that the browser supports is used.
const TYPES = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm", "video/mp4"];
const BITS_PER_SECOND = 6_000_000; // as a dive camera's 1080p; the default blurs a hand that moves.
const CHUNK = 1000; // ms: what is lost at most when the tab crashes.

/**
 * Count down from `from` to 1, one per second, and call `show(null)` at the end. Resolves to false
 * when `signal` aborts.
 *
 * @param {number} from
 * @param {(left: number | null) => void} show
 * @param {AbortSignal} signal
 * @returns {Promise<boolean>}
 */
export function countDown(from, show, signal) {
  return new Promise((resolve) => {
    let left = from;
    const finish = (/** @type {boolean} */ whole) => {
      clearInterval(timer);
      show(null);
      resolve(whole);
    };
    const timer = setInterval(() => {
      left -= 1;
      if (left) show(left);
      else finish(true);
    }, 1000);
    signal.addEventListener("abort", () => finish(false), { once: true });
    show(left);
  });
}

const two = (/** @type {number} */ number) => String(number).padStart(2, "0");

/**
 * @param {string} what
 * @param {Date} date
 * @param {string} type
 */
function nameAt(what, date, type) {
  const day = [date.getFullYear(), two(date.getMonth() + 1), two(date.getDate())].join("-");
  const hour = [date.getHours(), date.getMinutes(), date.getSeconds()].map(two).join("-");
  return `${what} ${day} ${hour}.${type.startsWith("video/mp4") ? "mp4" : "webm"}`;
}

/** @typedef {ReturnType<typeof record>} Recording */

/**
 * Record a stream. `stop(what)` resolves to the file, whose name is `what` and the time at which it
 * began, or to null when nothing was recorded.
 *
 * @param {MediaStream} stream
 */
export function record(stream) {
  const mimeType = TYPES.find((type) => MediaRecorder.isTypeSupported(type));
  const recorder = new MediaRecorder(stream, { mimeType, videoBitsPerSecond: BITS_PER_SECOND });
  const began = new Date();
  /** @type {Blob[]} */
  const parts = [];
  recorder.ondataavailable = ({ data }) => {
    if (data.size) parts.push(data);
  };
  const stopped = new Promise((resolve) => {
    recorder.onstop = resolve;
  });
  recorder.start(CHUNK);
  return {
    began,
    async stop(what = "camera") {
      if (recorder.state !== "inactive") recorder.stop();
      await stopped;
      const type = recorder.mimeType || mimeType || "";
      return parts.length
        ? new File(parts, nameAt(what, began, type), { type: type.split(";")[0] })
        : null;
    },
  };
}
