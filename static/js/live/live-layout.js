// The elements of the view, before anything is seen.

import { olderClipsButton } from "../clips/older-clips.js";
import { h, WRITES } from "../core/dom.js";
import { SALUTE } from "../clips/salute-threshold.js";
import { saluteHand } from "../clips/salutes.js";

/**
 * @param {string} id
 * @param {string} text
 */
const choice = (id, text) => h("button", { type: "button", id, "aria-pressed": "false" }, text);
/**
 * @param {string} id
 * @param {string} text
 * @param {string} title
 * @param {boolean} checked
 */
const check = (id, text, title, checked) =>
  h(
    "label",
    { className: "check", title },
    h("input", { type: "checkbox", id, checked }),
    h("span", { id: `${id}-text` }, text),
  );

const STEPS = [
  ["salute", "Salute"],
  ["gesture", "Gesture"],
  ["closing", "Salute"],
];

function picture() {
  return h(
    "div",
    { className: "camera-picture", id: "live-picture" },
    h("video", {
      id: "live-video",
      muted: true,
      playsInline: true,
      "aria-label": "What the camera sees",
    }),
    h("div", { className: "camera-idle", id: "live-idle" }, saluteHand(), "No source is running"),
    h("p", {
      className: "live-count",
      id: "live-count",
      role: "timer",
      "aria-live": "assertive",
      hidden: true,
    }),
    h("div", { className: "camera-problem", id: "live-problem", role: "alert", hidden: true }),
  );
}

function controls() {
  return h(
    "div",
    { className: "live-controls" },
    h(
      "div",
      { className: "segments", role: "group", "aria-label": "Source" },
      choice("live-from-camera", "Camera"),
      choice("live-from-clip", "Clip"),
    ),
    h("select", { id: "live-cameras", "aria-label": "Camera", hidden: true }),
    h("select", { id: "live-clips", "aria-label": "Clip", hidden: true }),
    olderClipsButton(),
    check(
      "live-every",
      "Every frame",
      "Processes every frame, also when this machine is slower than the clip",
      false,
    ),
    check(
      "live-autostop",
      "Stop after the closing salute",
      "Ends a recording when a take ends, without a click",
      true,
    ),
    h("span", { className: "spacer" }),
    h("button", {
      type: "button",
      id: "live-record",
      ...WRITES,
      title: "Record a clip, after a countdown (R)",
    }),
    h("button", {
      type: "button",
      id: "live-start",
      className: "primary",
      title: "Start or stop watching (Space)",
    }),
  );
}

/** Make what the view holds. */
export function panel() {
  return [
    h(
      "section",
      { className: "live-stage", "aria-label": "Live picture" },
      h("h1", {}, "Live recognition"),
      picture(),
      h(
        "div",
        { className: "live-state" },
        h(
          "ol",
          { className: "live-steps", id: "live-steps" },
          STEPS.map(([name, text]) => h("li", { id: `live-step-${name}` }, text)),
        ),
        h("p", { id: "live-instruction", role: "status" }),
        h(
          "label",
          { className: "live-salute", id: "live-meter" },
          h("span", { id: "live-held" }, "Salute"),
          h("meter", { id: "live-salute", min: 0, max: 1, low: SALUTE, value: 0 }),
        ),
      ),
      controls(),
    ),
    h(
      "aside",
      { className: "live-side", "aria-label": "Recognised live" },
      h("div", { id: "live-result", "aria-live": "polite" }),
      h("p", { className: "dim", id: "live-language" }),
      h(
        "div",
        { className: "live-head" },
        h("h2", {}, "Recognised"),
        h("button", { type: "button", className: "link", id: "live-clear", hidden: true }, "Clear"),
      ),
      h("ol", {
        className: "live-recognised",
        id: "live-recognised",
        "aria-label": "Recognised, newest first",
      }),
      h(
        "p",
        { className: "live-slow", id: "live-slow", hidden: true },
        "Too few frames per second to recognise gestures. Close other programs, or record a clip: all of its frames are used.",
      ),
      h("dl", { className: "live-speed", id: "live-speed" }),
    ),
  ];
}
