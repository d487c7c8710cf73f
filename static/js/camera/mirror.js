// The preview of a camera: as in a mirror, unless the camera looks away from who watches it.

/**
 * Whether a source is shown mirrored: a camera that faces the diver is, and one of which that is
 * not known; a phone's rear camera and a clip are not.
 *
 * @param {HTMLVideoElement["srcObject"]} source
 */
export function isMirrored(source) {
  if (!source || !("getVideoTracks" in source)) return false;
  return source.getVideoTracks()[0]?.getSettings().facingMode !== "environment";
}

/**
 * Mirror the picture of a video where its source asks for it.
 *
 * @param {HTMLElement} picture
 * @param {HTMLVideoElement} video
 */
export const mirror = (picture, video) =>
  picture.classList.toggle("mirrored", isMirrored(video.srcObject));
