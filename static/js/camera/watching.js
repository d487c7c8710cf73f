// Watching a video: its pictures go to the server, which finds poses and takes in them.

import { openLink } from "./live-socket.js";
import { grab, stepFrames, watchFrames } from "./video-source.js";

/** @import { Handlers } from "./live-messages.d.ts" */

/**
 * Let the server watch a video, from `begin()` to `stop()`; each kind of answer has a handler.
 *
 * @param {HTMLVideoElement} video
 * @param {Handlers} handlers
 * @param {Parameters<typeof openLink>[1]} [place]
 */
export function watch(video, handlers, place) {
  const { send, ready, answered, close, ...link } = openLink(handlers, place);
  let grabbing = false;
  let stopFrames = () => {};

  /**
   * Send the picture on display, unless enough are under way. `time` is the picture's second in the
   * video, `at` the second of its capture by the page's clock.
   *
   * @param {number} time
   * @param {number} [at]
   */
  async function look(time, at = performance.now() / 1000) {
    if (grabbing || !ready()) return;
    grabbing = true;
    const picture = await grab(video);
    grabbing = false;
    if (picture) await send(time, at, picture);
  }

  /** @param {number} time */
  async function lookAndWait(time) {
    const answer = answered();
    await look(time);
    await answer;
  }

  return {
    ...link,
    look,
    /**
     * Send the pictures from now on: as many as the server looks at, or every one of a clip.
     *
     * @param {boolean} [every]
     */
    begin: (every = false) => {
      stopFrames = every ? stepFrames(video, lookAndWait) : watchFrames(video, look);
    },
    /** Send no more pictures, and close the connection. */
    stop: () => {
      stopFrames();
      close();
    },
  };
}
