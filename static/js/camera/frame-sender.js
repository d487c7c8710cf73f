// Sending the pictures of a video to the server, which finds poses in them.

import { grab } from "./video-source.js";

/** @import { openLink } from "./live-socket.js" */

/**
 * Make a function that sends the picture on display, unless enough are under way. `time` is the
 * picture's second in the video, `at` the second of its capture by the page's clock.
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
