// The source of live frames: a camera, or a clip played as if live.

const LONGEST_SIDE = 960; // px. The models look at a hand in 224; a smaller picture would blur it.
const QUALITY = 0.8; // of the JPEG: a fifth of the bytes of 0.95, and the same landmarks.
const CLIP_STEP = 1 / 12; // s. A salute is held for 0.3 s: at least three frames of it are seen.

/** Whether the browser may give this page a camera at all. */
export const cameraPossible = () => Boolean(navigator.mediaDevices?.getUserMedia);

/** @type {Record<string, [string, string]>} */
const REASONS = {
  NotAllowedError: [
    "The camera was not allowed",
    "Allow it for this page, beside its address, and for the browser in the system\u2019s privacy settings. Then try again.",
  ],
  NotFoundError: [
    "No camera found",
    "Plug one in, and see that it is switched on. Then try again.",
  ],
  NotReadableError: [
    "The camera does not answer",
    "Another program or tab may be using it. Close that one, then try again.",
  ],
  AbortError: [
    "The camera does not answer",
    "It failed while it was started. Unplug it and plug it in again, then try again.",
  ],
  OverconstrainedError: [
    "That camera is gone",
    "Choose another one, or plug it in again. Then try again.",
  ],
};

/**
 * Why a camera stopped sending, and what can be done `instead`.
 *
 * @param {string} instead
 */
export const cameraLost = (instead) => ({
  title: "The camera was lost",
  text: `It was unplugged, or is no longer allowed. What was recorded until then is kept. Without a camera, ${instead}.`,
});

/**
 * Explain why there is no camera, `{ title, text }`, and what can be done `instead`.
 *
 * @param {Error} error
 * @param {string} instead
 */
export function whyNoCamera(error, instead) {
  if (!cameraPossible()) {
    return {
      title: "No camera over an open connection",
      text: `Browsers give cameras only to pages over HTTPS, or from the machine itself (127.0.0.1, localhost). This page comes from ${location.origin}. Open it on that machine or over HTTPS, or ${instead}.`,
    };
  }
  const [title, text] = REASONS[error.name] ?? ["The camera cannot be used", error.message];
  return { title, text: `${text} Without a camera, ${instead}.` };
}

/**
 * Show a camera in a video element; `lost()` is called when it stops sending.
 *
 * @param {HTMLVideoElement} video
 * @param {string} deviceId
 * @param {() => void} lost
 */
export async function showCamera(video, deviceId, lost) {
  if (!cameraPossible()) throw new TypeError("no camera");
  const wanted = { width: { ideal: 1280 }, height: { ideal: 720 }, frameRate: { ideal: 30 } };
  const stream = await navigator.mediaDevices.getUserMedia({
    video: deviceId ? { ...wanted, deviceId: { exact: deviceId } } : wanted,
    audio: false,
  });
  for (const track of stream.getTracks()) track.onended = lost;
  video.srcObject = stream;
  await video.play();
}

/**
 * The cameras to choose from, and the one on display, or else the `chosen` one. The browser names
 * cameras only after the user has allowed one.
 *
 * @param {HTMLVideoElement} video
 * @param {string} chosen
 */
export async function listCameras({ srcObject }, chosen) {
  const devices = await navigator.mediaDevices.enumerateDevices();
  const found = devices.filter(({ kind, deviceId }) => kind === "videoinput" && deviceId);
  const current =
    srcObject instanceof MediaStream && srcObject.getVideoTracks()[0]?.getSettings().deviceId;
  return {
    device: current || chosen,
    cameras: found.map(
      ({ deviceId, label }) => /** @type {[string, string]} */ ([deviceId, label || "Camera"]),
    ),
  };
}

/**
 * Load a clip into a video element, at its beginning.
 *
 * @param {HTMLVideoElement} video
 * @param {string} url
 */
export async function showClip(video, url) {
  const loaded = new Promise((resolve, reject) => {
    video.onloadeddata = resolve;
    video.onerror = () =>
      reject(
        new Error(
          "This browser cannot play the clip\u2019s codec. Convert it to an MP4 with H.264, or recognise it in the studio.",
        ),
      );
  });
  video.src = url;
  await loaded;
}

/**
 * Release the camera or clip.
 *
 * @param {HTMLVideoElement} video
 */
export function release(video) {
  const { srcObject } = video;
  if (srcObject instanceof MediaStream) for (const track of srcObject.getTracks()) track.stop();
  video.onerror = video.onloadeddata = video.onended = null;
  video.srcObject = null;
  video.removeAttribute("src");
  video.load();
}

const canvas = document.createElement("canvas");

/**
 * The picture on display as a JPEG; null while there is none.
 *
 * @param {HTMLVideoElement} video
 * @returns {Promise<Blob | null>}
 */
export function grab(video) {
  const { videoWidth: width, videoHeight: height } = video;
  if (!width) return Promise.resolve(null);
  const scale = Math.min(1, LONGEST_SIDE / Math.max(width, height));
  canvas.width = Math.round(width * scale);
  canvas.height = Math.round(height * scale);
  canvas.getContext("2d", { alpha: false })?.drawImage(video, 0, 0, canvas.width, canvas.height);
  return new Promise((resolve) => {
    canvas.toBlob(resolve, "image/jpeg", QUALITY);
  });
}

/**
 * Call `seen(time, captured)` for each new picture of a running video, until the returned function
 * is called. `time` is in seconds of the camera's or clip's clock, `captured` of the page's.
 *
 * @param {HTMLVideoElement} video
 * @param {(time: number, captured: number) => void} seen
 */
export function watchFrames(video, seen) {
  let running = true;
  const live = video.srcObject !== null;
  const next = () => {
    if (!running) return;
    // Firefox before 132 has no such callback; there each redraw of the screen counts.
    if (video.requestVideoFrameCallback) video.requestVideoFrameCallback(frame);
    else requestAnimationFrame((now) => frame(now, {}));
  };
  /** @type {(now: number, times: { captureTime?: number, mediaTime?: number }) => void} */
  const frame = (now, { captureTime, mediaTime }) => {
    if (!running) return;
    const captured = (captureTime ?? now) / 1000;
    seen(live ? captured : (mediaTime ?? video.currentTime), captured);
    next();
  };
  next();
  return () => {
    running = false;
  };
}

/**
 * Step through a clip without skipping frames: `seen(time)` is awaited before the next one.
 *
 * @param {HTMLVideoElement} video
 * @param {(time: number) => Promise<void>} seen
 */
export function stepFrames(video, seen) {
  let running = true;
  const shown = (/** @type {number} */ time) =>
    new Promise((resolve) => {
      video.onseeked = resolve;
      video.currentTime = time;
    });
  const run = async () => {
    for (let time = 0; running && time < video.duration; time += CLIP_STEP) {
      await shown(time);
      if (running) await seen(time);
    }
    if (running) video.onended?.(new Event("ended"));
  };
  run();
  return () => {
    running = false;
  };
}
