// Keypoint files of other programs: identifying them, and asking the user for missing data.

import { ask } from "../core/dialogs.js";

const HEAD = 65536; // bytes at the beginning of a file, which show its kind.

// Keys of a list of frames, of people (MMPose, COCO) or of their images.
const KEYS = "frames|poses|data|results|instance_info|annotations|images|categories";
const LISTS = new RegExp(`^\\s*(\\[|\\{[^]*?"(${KEYS})"\\s*:\\s*\\[)`);

/**
 * The kind of a .json file: "language", "keypoints", or "frame", one frame of OpenPose.
 * A language is an object of gestures; keypoints are a list of frames, or an object with one.
 *
 * @param {Blob} file
 */
export async function kindOfJson(file) {
  const head = await file.slice(0, HEAD).text();
  if (/"osg-studio\/gesture-language"/.test(head)) return "language";
  if (/^\s*\{[^{]*"people"\s*:\s*\[/.test(head)) return "frame";
  return LISTS.test(head) ? "keypoints" : "language";
}

/** @type {Record<string, string>} */
const NEEDS = {
  frame_rate_needed: "It numbers its frames and has no times.",
  frame_size_needed:
    "Its coordinates are fractions of the picture, and the picture\u2019s size is not in the file.",
};

/**
 * Whether an upload was refused because its frame rate or size is not known.
 *
 * @param {{ code?: string }} error
 */
export const needsVideo = ({ code }) => (code ?? "") in NEEDS;

/** @param {string} text */
const size = (text) => text.trim().toLowerCase().replace("\u00d7", "x");

/**
 * Ask about the video that the keypoints were found in; resolves to fields of the upload, or null.
 *
 * @param {string} name
 * @param {{ code?: string }} error
 * @param {Record<string, string>} [given]
 */
export function askForVideo(name, { code }, given = {}) {
  const required = code === "frame_size_needed";
  return ask({
    title: "What was the video like?",
    text: `${name} holds keypoints and no video. ${NEEDS[code ?? ""]}`,
    fields: [
      {
        name: "frame_rate",
        label: "Frames a second",
        value: given.frame_rate ?? "30",
        required: code === "frame_rate_needed",
        most: 12,
      },
      {
        name: "frame_size",
        label: "Width x height in pixels",
        value: given.frame_size ?? "",
        required,
        most: 16,
        hint: "As 1920x1080. Needed for coordinates that are fractions of the picture.",
      },
    ],
    action: "Add the clip",
    submit: (values) => {
      if (values.frame_rate && !(Number(values.frame_rate) > 0))
        throw new Error(
          `\u201c${values.frame_rate}\u201d is no number of frames a second; type one, as 29.97.`,
        );
      if (values.frame_size && !/^\d+\s*x\s*\d+$/.test(size(values.frame_size)))
        throw new Error(
          `\u201c${values.frame_size}\u201d is no size; type width and height, as 1920x1080.`,
        );
      return Object.fromEntries(
        Object.entries({ ...values, frame_size: size(values.frame_size) }).filter(
          ([, value]) => value,
        ),
      );
    },
  });
}
