// The gestures to show, one after the other: each take is recorded or chosen, sent, and answered.

import { cameraPossible } from "../camera/video-source.js";
import { h } from "../core/dom.js";
import { takeCamera } from "./take-camera.js";
import { answerTake, findJudged, sendTake } from "./take-sending.js";

/** @import { Invited, InvitedGesture } from "../core/types.d.ts" */

/**
 * @typedef {"open" | "sending" | "waiting" | "asked" | "held" | "added" | "removed" | "returned" | "failed"} Standing
 * @typedef {{ gesture: InvitedGesture, standing: Standing, reason: string, id: string, share: number, file: File | null, cancel: (() => void) | null }} Entry
 * @typedef {{ kept: { name: string, takes: Record<string, string> }, write: () => void }} Memory
 */

const SHOW_MS = 4000; // for a look at a take before it is sent by itself
const LONGEST = 20; // seconds of a recording
const AROUND = { salute: 6, pose: 7, gesture: 4, none: 4 }; // seconds before and after the gesture

const HOW_TO = {
  salute: "Hold a Vulcan salute, show the gesture, salute again.",
  pose: "Hold the starting pose of the arms, show the gesture, hold the closing pose.",
  gesture: "Stand still, show the gesture, stand still.",
  none: "Stand still, show the gesture, stand still.",
};

/** @type {Record<Standing, string>} */
const WORDS = {
  open: "to show",
  sending: "being sent",
  waiting: "being looked at",
  asked: "please answer",
  held: "is looked at by whoever invited you",
  added: "added",
  removed: "not taken",
  returned: "show it again",
  failed: "not sent",
};

const DONE = ["held", "added", "removed"]; // Nothing more is to be done by who shows.
const TO_SHOW = ["asked", "open", "returned", "failed"];

/** @param {Entry} entry */
const wordOf = ({ standing, share }) =>
  standing === "sending" ? `${WORDS.sending}, ${Math.round(100 * share)} %` : WORDS[standing];

/** @param {string} text */
export const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);

/**
 * Show the gestures of a language one after the other, and send the takes.
 *
 * @param {HTMLElement} root
 * @param {Invited} invited
 * @param {Memory} memory
 */
export function showGestures(root, invited, memory) {
  /** @type {Entry[]} */
  const entries = invited.gestures.map((gesture) => ({
    gesture,
    standing: "open",
    reason: "",
    id: "",
    share: 0,
    file: null,
    cancel: null,
  }));
  let current = entries[0];
  let handsFree = false;
  /** @type {AbortController | null} */
  let taking = null; // the take before the camera
  let wake = () => {}; // called when something has changed

  const changed = () =>
    new Promise((resolve) => {
      wake = () => resolve(null);
    });

  const figure = h("img", { className: "figure", width: 224, height: 224, alt: "" });
  const label = h("h2");
  const description = h("p", { className: "dim description" });
  const step = h("p", { className: "step", role: "status" });
  const reason = h("p", { className: "reason", role: "alert", hidden: true });
  const view = h("p", { className: "dim view-of-drawings" }, "Drawn as in a mirror.");
  const asked = h(
    "div",
    { className: "shown" },
    figure,
    h("div", {}, label, view, description, reason),
  );
  const card = h("section", { className: "card" });
  const preview = h("video", {
    className: "preview",
    muted: true,
    playsInline: true,
    hidden: true,
  });
  const actions = h("div", { className: "actions" });
  const list = h("ul", { className: "gestures", "aria-label": "Gestures" });
  const sum = h("p", { className: "sum", role: "status" });
  const bar = h("progress", { max: entries.length, value: 0, "aria-label": "Gestures added" });
  const camera = takeCamera({ ended: () => endHandsFree(), again: () => beginHandsFree() });

  const standingAt = (/** @type {Standing} */ wanted) =>
    entries.find(({ standing }) => standing === wanted);
  /** The next gesture to show. */
  const next = () => standingAt("asked") ?? standingAt("open") ?? standingAt("returned");
  const busy = () =>
    entries.some(({ standing }) => standing === "sending" || standing === "waiting");

  /**
   * @param {Entry} entry
   * @param {Partial<Entry>} change
   */
  function put(entry, change) {
    Object.assign(entry, change);
    drawList();
    if (entry === current && !taking) drawCurrent();
    wake();
  }

  /**
   * Wait for the answer to a take that was sent, after saying whether it is the gesture.
   *
   * @param {Entry} entry
   * @param {string} id
   * @param {boolean | null} [confirmed]
   */
  async function follow(entry, id, confirmed = null) {
    put(entry, { standing: "waiting", id, cancel: null });
    try {
      // An answer that does not arrive is asked for again.
      if (confirmed !== null) await answerTake(id, confirmed).catch(() => {});
      const { status, reason: why } = await findJudged(id);
      put(entry, { standing: status === "waiting" ? "held" : status, reason: why ?? "" });
    } catch (error) {
      const gone = error.status === 404;
      put(
        entry,
        gone ? { standing: "open" } : { standing: "failed", reason: capital(error.message) },
      );
      delete memory.kept.takes[entry.gesture.label];
    }
    memory.write();
    advance();
  }

  /**
   * The buttons that answer whether a take is the gesture.
   *
   * @param {Entry} entry
   */
  const answers = (entry) => {
    const answer = (/** @type {string} */ words, /** @type {boolean} */ confirmed) =>
      h(
        "button",
        {
          type: "button",
          className: confirmed ? "primary" : "",
          onclick: () => follow(entry, entry.id, confirmed),
        },
        words,
      );
    return [answer("Yes, it is", true), answer("Show it again", false)];
  };

  /**
   * Send a clip as the take of a gesture.
   *
   * @param {Entry} entry
   * @param {File} file
   */
  async function send(entry, file) {
    if (file.size > invited.most_bytes) {
      const most = Math.floor(invited.most_bytes / 1e6);
      const size = Math.ceil(file.size / 1e6);
      put(entry, {
        standing: "failed",
        reason: `The clip has ${size} MB, and ${most} MB are taken. Record a shorter one.`,
      });
      return;
    }
    const progress = (/** @type {number} */ share) => {
      entry.share = share;
      // In place, so that the button beside it can be pressed.
      const word = list.children[entries.indexOf(entry)]?.querySelector("span");
      if (word && entry.standing === "sending") word.textContent = wordOf(entry);
    };
    const diver = memory.kept.name;
    const { answer, cancel } = sendTake({ label: entry.gesture.label, diver, file, progress });
    put(entry, {
      standing: "sending",
      reason: "",
      share: 0,
      file,
      cancel: () => {
        cancel();
        put(entry, { standing: "open", file: null, cancel: null });
      },
    });
    advance();
    try {
      const take = await answer;
      memory.kept.takes[entry.gesture.label] = take.id;
      memory.write();
      entry.file = null;
      follow(entry, take.id);
    } catch (error) {
      const standing = error.code === "already_shown" ? "added" : "failed";
      put(entry, { standing, reason: capital(error.message), cancel: null });
      advance();
    }
  }

  /** Go to a question or the next gesture to show, unless one is being shown. */
  function advance() {
    if (taking || handsFree) return;
    const stays = TO_SHOW.includes(current.standing) ? current : null;
    current = standingAt("asked") ?? stays ?? next() ?? standingAt("failed") ?? current;
    drawCurrent();
    drawList();
  }

  /** @param {Entry} entry */
  function choose(entry) {
    if (handsFree) return;
    current = entry;
    drawCurrent();
    drawList();
    root.scrollIntoView({ block: "start" });
  }

  /** @param {Entry} entry */
  function row(entry) {
    const { gesture, standing, cancel, reason: why } = entry;
    const shows = TO_SHOW.includes(standing);
    return h(
      "li",
      {
        className: `gesture ${standing}`,
        "aria-current": entry === current && !DONE.includes(standing) ? "true" : "false",
      },
      h("img", { src: gesture.image, width: 44, height: 44, alt: "" }),
      h(
        "div",
        {},
        shows && !handsFree
          ? h(
              "button",
              { type: "button", className: "link", onclick: () => choose(entry) },
              gesture.label,
            )
          : h("b", {}, gesture.label),
        h("span", {}, wordOf(entry)),
        why ? h("span", { className: "dim" }, why) : null,
      ),
      cancel ? h("button", { type: "button", onclick: cancel }, "Cancel") : null,
    );
  }

  function drawList() {
    const added = entries.filter(({ standing }) => standing === "added").length;
    bar.value = added;
    const words = `${added} of ${entries.length} added`;
    if (sum.textContent !== words) sum.textContent = words;
    list.replaceChildren(...entries.map(row));
  }

  /**
   * The ways to a clip of a gesture without the live camera.
   *
   * @param {Entry} entry
   */
  function fileInputs(entry) {
    const choice = (/** @type {string} */ words, /** @type {Record<string, any>} */ more) => {
      const input = h("input", {
        type: "file",
        accept: "video/*",
        className: "visually-hidden",
        ...more,
      });
      input.onchange = () => {
        const [file] = input.files ?? [];
        if (file) send(entry, file);
        input.value = "";
      };
      return h("label", { className: "button" }, words, input);
    };
    return [choice("Record with the phone", { capture: "user" }), choice("Choose a clip", {})];
  }

  function drawCurrent() {
    const { gesture, standing, reason: why } = current;
    figure.src = gesture.image;
    figure.alt = `The drawing of ${gesture.label}, from the dot along the arrow`;
    label.textContent = gesture.label;
    description.textContent = gesture.description;
    reason.hidden = !why || DONE.includes(standing);
    reason.textContent = why;
    card.classList.toggle("live", handsFree);
    if (handsFree) return;
    const done = !next() && !standingAt("failed");
    asked.hidden = done;
    step.textContent = stepWords(done);
    if (standing === "asked") actions.replaceChildren(...answers(current));
    else actions.replaceChildren(...(done ? [] : waysToShow(current)));
  }

  /**
   * What is to be done now, or that all is done.
   *
   * @param {boolean} done
   */
  function stepWords(done) {
    const added = entries.filter(({ standing }) => standing === "added").length;
    if (entries.every(({ standing }) => DONE.includes(standing)))
      return `All gestures are ${added === entries.length ? "added" : "shown"}. Thank you! You can close this page.`;
    if (done) return "All gestures are shown. Wait for the answers.";
    return current.standing === "asked" ? "Please answer." : HOW_TO[invited.trigger];
  }

  /**
   * The buttons that show a gesture.
   *
   * @param {Entry} entry
   */
  function waysToShow(entry) {
    const { standing, file } = entry;
    const retry =
      standing === "failed" && file
        ? h(
            "button",
            { type: "button", className: "primary", onclick: () => send(entry, file) },
            "Send again",
          )
        : null;
    const live =
      cameraPossible() && !retry
        ? h(
            "button",
            { type: "button", className: "primary", onclick: beginHandsFree },
            "Show hands-free",
          )
        : null;
    return [retry, live, ...fileInputs(entry)].filter((each) => each !== null);
  }

  /**
   * Show a recorded take for a moment; whether it is to be sent.
   *
   * @param {File} file
   * @param {AbortSignal} signal
   */
  function approve(file, signal) {
    const address = URL.createObjectURL(file);
    preview.src = address;
    preview.hidden = false;
    camera.element.hidden = true;
    preview.play().catch(() => {}); // A browser that plays nothing by itself still sends it.
    step.textContent = "This is sent in a moment.";
    return new Promise((/** @type {(approved: boolean) => void} */ resolve) => {
      const finish = (/** @type {boolean} */ approved) => {
        clearTimeout(timer);
        preview.hidden = true;
        preview.removeAttribute("src");
        URL.revokeObjectURL(address);
        camera.element.hidden = false;
        resolve(approved);
      };
      const timer = setTimeout(() => finish(true), SHOW_MS);
      signal.addEventListener("abort", () => finish(false), { once: true });
      actions.replaceChildren(
        h(
          "button",
          { type: "button", className: "primary", onclick: () => finish(true) },
          "Send now",
        ),
        h("button", { type: "button", onclick: () => finish(false) }, "Show it again"),
        stopButton(),
      );
    });
  }

  const stopButton = () => h("button", { type: "button", onclick: () => endHandsFree() }, "Stop");

  /** @param {Entry} entry */
  async function takeOne(entry) {
    current = entry;
    drawList();
    taking = new AbortController();
    drawCurrent();
    actions.replaceChildren(stopButton());
    const seconds = Math.min(
      LONGEST,
      Math.ceil(entry.gesture.seconds ?? 2) + AROUND[invited.trigger],
    );
    const { trigger } = invited;
    const file = await camera.take({ seconds, trigger, signal: taking.signal }, (at) => {
      const ready = at === "ready";
      step.textContent = ready
        ? `Next: ${entry.gesture.label}. Step back.`
        : HOW_TO[invited.trigger];
      const done = h("button", { type: "button", onclick: () => taking?.abort("done") }, "Done");
      actions.replaceChildren(...(ready ? [stopButton()] : [done, stopButton()]));
    });
    taking = handsFree ? new AbortController() : null;
    const wanted = file && taking && (await approve(file, taking.signal));
    taking = null;
    if (wanted) send(entry, file);
  }

  /** Show the gestures one after the other before the camera, the chosen one first. */
  async function beginHandsFree() {
    let chosen = TO_SHOW.includes(current.standing) ? current : null;
    actions.replaceChildren();
    step.textContent = "Starting the camera.";
    if (!(await camera.start())) return drawCurrent();
    handsFree = true;
    const awake = await navigator.wakeLock?.request("screen").catch(() => null);
    while (handsFree) {
      const entry = chosen ?? next();
      chosen = null;
      if (entry?.standing === "asked") {
        current = entry;
        drawCurrent();
        step.textContent = "Please answer.";
        actions.replaceChildren(...answers(entry), stopButton());
        await changed();
      } else if (entry) await takeOne(entry);
      else if (!busy()) break;
      else {
        step.textContent = "All gestures are shown. Wait for the answers.";
        actions.replaceChildren(stopButton());
        await changed();
      }
    }
    await awake?.release();
    endHandsFree();
    return undefined;
  }

  function endHandsFree() {
    handsFree = false;
    taking?.abort("drop");
    taking = null;
    camera.stop();
    wake();
    drawList();
    advance();
  }

  card.append(asked, camera.element, preview, step, actions);
  card.ondragover = (event) => event.preventDefault();
  card.ondrop = (event) => {
    event.preventDefault();
    const [file] = event.dataTransfer?.files ?? [];
    if (file && !handsFree) send(current, file);
  };
  root.replaceChildren(h("header", {}, h("h1", {}, invited.language), sum, bar), card, list);
  addEventListener("pagehide", camera.stop);
  for (const entry of entries) {
    const known = memory.kept.takes[entry.gesture.label];
    if (known) follow(entry, known);
  }
  drawList();
  advance();
}
