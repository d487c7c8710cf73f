// The pictures of a video on their way to the server, which looks at them.

import { grab } from "./video-source.js";

/** @import { openLink } from "./live-socket.js" */

/**
 * Make a function that sends the picture on display, unless enough are on their way; it is of
 * `time` seconds, and was captured at `at` by the page's clock.
 *
 * @param {HTMLVideoElement} video
 * @param {ReturnType<typeof openLink>} link
 */
export function frameSender(video, link) {
  let grabbing = false;
  /** @type {(time: number, at: number) => Promise<void>} */
  return async (time, at) => {
    if (grabbing || !link.ready()) return;
    grabbing = true;
    const picture = await grab(video);
    grabbing = false;
    if (picture) await link.send(time, at, picture);
  };
}
