// The preview of a camera: mirrored, unless the camera faces away from the viewer. Drawings of
// gestures beside it are mirrored with it, by the styles.

/**
 * Whether a source is shown mirrored: true for a camera that faces the diver or whose direction is
 * unknown, false for a phone's rear camera and a clip.
 *
 * @param {HTMLVideoElement["srcObject"]} source
 */
export function isMirrored(source) {
  if (!source || !("getVideoTracks" in source)) return false;
  return source.getVideoTracks()[0]?.getSettings().facingMode !== "environment";
}
