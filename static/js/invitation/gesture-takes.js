// The gestures to show, one after the other: each take is recorded or chosen, sent, and answered.

import { howTo, isSlow, situation } from "../camera/take-steps.js";
import { cameraPossible } from "../camera/video-source.js";
import { buttonOf, html, nothing, progressBar, render } from "../templates.js";
import { takeCamera } from "./take-camera.js";
import { answerTake, findJudged, sendTake } from "./take-sending.js";

/** @import { Invited, InvitedGesture } from "../core/types.d.ts" */

/**
 * `picture` is the address of the take that was sent, until it is answered for good.
 *
 * @typedef {"open" | "sending" | "waiting" | "asked" | "held" | "added" | "removed" | "returned" | "failed"} Standing
 * @typedef {{ gesture: InvitedGesture, standing: Standing, reason: string, id: string, share: number, file: File | null, picture: string, cancel: (() => void) | null }} Entry
 * @typedef {{ kept: { name: string, takes: Record<string, string> }, write: () => void }} Memory
 */

const SHOW_MS = 4000; // for a look at a take before it is sent by itself
const LONGEST = 20; // seconds of a recording
/** @type {Record<string, number>} */
const AROUND = { salute: 6, pose: 7, gesture: 4, none: 4 }; // seconds before and after the gesture

const SLOW = "Few pictures a second arrive. Press Done after the gesture.";

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
    picture: "",
    cancel: null,
  }));
  // A take shows one gesture, also where gestures are a trigger.
  const instructions = howTo(invited.trigger === "gesture" ? "none" : invited.trigger);
  let current = entries[0];
  let handsFree = false;
  /** @type {{ words: string, actions: unknown, note: string }} what the camera asks for */
  let prompt = { words: "", actions: nothing, note: "" };
  let preview = ""; // the address of a take on display before it is sent
  /** @type {AbortController | null} */
  let taking = null; // the take before the camera
  let wake = () => {}; // called when something has changed

  const changed = () =>
    new Promise((resolve) => {
      wake = () => resolve(null);
    });

  const camera = takeCamera({
    draw: () => draw(),
    ended: () => endHandsFree(),
    again: () => beginHandsFree(),
  });

  const standingAt = (/** @type {Standing} */ wanted) =>
    entries.find(({ standing }) => standing === wanted);
  /** The next gesture to show. */
  const next = () => standingAt("asked") ?? standingAt("open") ?? standingAt("returned");
  const busy = () =>
    entries.some(({ standing }) => standing === "sending" || standing === "waiting");
  const countAdded = () => entries.filter(({ standing }) => standing === "added").length;

  /**
   * @param {Entry} entry
   * @param {Partial<Entry>} change
   */
  function put(entry, change) {
    Object.assign(entry, change);
    if (DONE.includes(entry.standing)) URL.revokeObjectURL(entry.picture);
    draw();
    wake();
  }

  /**
   * Say what comes before the camera, and show the buttons for it.
   *
   * @param {string} words
   * @param {unknown[]} actions
   * @param {string} [note]
   */
  function say(words, actions, note = "") {
    prompt = { words, actions, note };
    draw();
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
   * The buttons that answer whether a take is the gesture; none is recommended.
   *
   * @param {Entry} entry
   */
  const answers = (entry) => [
    buttonOf("Yes, it is", () => follow(entry, entry.id, true)),
    buttonOf("Show it again", () => follow(entry, entry.id, false)),
  ];

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
    const progress = (/** @type {number} */ share) => put(entry, { share });
    const diver = memory.kept.name;
    const { answer, cancel } = sendTake({ label: entry.gesture.label, diver, file, progress });
    URL.revokeObjectURL(entry.picture);
    put(entry, {
      standing: "sending",
      reason: "",
      share: 0,
      file,
      picture: URL.createObjectURL(file),
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
    draw();
  }

  /** @param {Entry} entry */
  function choose(entry) {
    if (handsFree) return;
    current = entry;
    draw();
    root.scrollIntoView({ block: "start" });
  }

  /** @param {Entry} entry */
  function row(entry) {
    const { gesture, standing, share, cancel, reason: why } = entry;
    const sent = standing === "sending" ? `, ${Math.round(100 * share)} %` : "";
    return html`<li
      class="gesture ${standing}"
      aria-current=${entry === current && !DONE.includes(standing)}
    >
      <img src=${gesture.image} width="44" height="44" alt="" />
      <div>
        ${
          TO_SHOW.includes(standing) && !handsFree
            ? buttonOf(gesture.label, () => choose(entry), { look: "link" })
            : html`<b>${gesture.label}</b>`
        }<span>${WORDS[standing]}${sent}</span>${why ? html`<span class="dim">${why}</span>` : nothing}
      </div>
      ${cancel ? buttonOf("Cancel", cancel) : nothing}
    </li>`;
  }

  /**
   * A way to a clip of a gesture without the live camera.
   *
   * @param {Entry} entry
   * @param {string} words
   * @param {unknown} capture
   */
  function fileInput(entry, words, capture) {
    const take = (/** @type {any} */ { target }) => {
      const [file] = target.files;
      if (file) send(entry, file);
      target.value = "";
    };
    return html`<label class="button"
      >${words}<input
        type="file"
        accept="video/*"
        class="visually-hidden"
        capture=${capture}
        @change=${take}
    /></label>`;
  }

  /**
   * The gesture to show, or the take of it that is asked about.
   *
   * @param {Entry} entry
   */
  function shown({ gesture, standing, reason }) {
    const why = DONE.includes(standing) ? "" : reason;
    return html`<div class="shown">
      <img
        class="figure"
        src=${gesture.image}
        width="224"
        height="224"
        alt="The drawing of ${gesture.label}, from the dot along the arrow"
      />
      <div>
        <h2>${gesture.label}</h2>
        <p class="dim view-of-drawings">Drawn as in a mirror.</p>
        <p class="dim description">${gesture.description}</p>
        <p class="reason" role="alert" ?hidden=${!why}>${why}</p>
      </div>
    </div>`;
  }

  /** A take of a moment ago: before it is sent, or while it is asked about. */
  function lastTake() {
    const address = preview || (current.standing === "asked" && current.picture);
    return address
      ? html`<video
          class="preview"
          .muted=${true}
          autoplay
          loop
          playsinline
          aria-label="Your take of ${current.gesture.label}"
          src=${address}
        ></video>`
      : nothing;
  }

  function draw() {
    const done = !next() && !standingAt("failed");
    const { words, actions, note } = handsFree
      ? prompt
      : { words: stepWords(done), actions: done ? nothing : waysToShow(current), note: "" };
    render(
      html`<header>
          <h1>${invited.language}</h1>
          <p class="sum" role="status">${countAdded()} of ${entries.length} added</p>
          ${progressBar("Gestures added", countAdded(), entries.length)}
        </header>
        <section
          class="card ${handsFree ? "live" : ""}"
          @dragover=${(/** @type {Event} */ event) => event.preventDefault()}
          @drop=${drop}
        >
          ${done && !handsFree ? nothing : shown(current)}${camera.picture({
            hidden: Boolean(preview) || !camera.isThere(),
          })}${lastTake()}
          <p class="step" role="status">${words}</p>
          <p class="dim" ?hidden=${!note}>${note}</p>
          <div class="actions">${actions}</div>
        </section>
        <ul class="gestures" aria-label="Gestures">
          ${entries.map(row)}
        </ul>`,
      root,
    );
  }

  /** @param {DragEvent} event */
  function drop(event) {
    event.preventDefault();
    const [file] = event.dataTransfer?.files ?? [];
    if (file && !handsFree) send(current, file);
  }

  /**
   * What is to be done now, or that all is done.
   *
   * @param {boolean} done
   */
  function stepWords(done) {
    if (entries.every(({ standing }) => DONE.includes(standing)))
      return `All gestures are ${countAdded() === entries.length ? "added" : "shown"}. Thank you! You can close this page.`;
    if (done) return "All gestures are shown. Wait for the answers.";
    return current.standing === "asked" ? "Please answer." : instructions;
  }

  /**
   * The buttons that show a gesture, or answer the question about it.
   *
   * @param {Entry} entry
   */
  function waysToShow(entry) {
    const { standing, file } = entry;
    if (standing === "asked") return answers(entry);
    const first =
      standing === "failed" && file
        ? buttonOf("Send again", () => send(entry, file), { look: "primary" })
        : cameraPossible()
          ? buttonOf("Show hands-free", beginHandsFree, { look: "primary" })
          : nothing;
    return [
      first,
      fileInput(entry, "Record with the phone", "user"),
      fileInput(entry, "Choose a clip", nothing),
    ];
  }

  /**
   * Show a recorded take for a moment; whether it is to be sent.
   *
   * @param {File} file
   * @param {AbortSignal} signal
   */
  function approve(file, signal) {
    preview = URL.createObjectURL(file);
    return new Promise((/** @type {(approved: boolean) => void} */ resolve) => {
      const finish = (/** @type {boolean} */ approved) => {
        clearTimeout(timer);
        URL.revokeObjectURL(preview);
        preview = "";
        resolve(approved);
      };
      const timer = setTimeout(() => finish(true), SHOW_MS);
      signal.addEventListener("abort", () => finish(false), { once: true });
      say("This is sent in a moment.", [
        buttonOf("Send now", () => finish(true), { look: "primary" }),
        buttonOf("Show it again", () => finish(false)),
        stopButton(),
      ]);
    });
  }

  const stopButton = () => buttonOf("Stop", () => endHandsFree());

  /** @param {Entry} entry */
  async function takeOne(entry) {
    current = entry;
    taking = new AbortController();
    const { label, seconds: length } = entry.gesture;
    const { trigger } = invited;
    const seconds = Math.min(LONGEST, Math.ceil(length ?? 2) + AROUND[trigger]);
    const done = buttonOf("Done", () => taking?.abort("done"));
    const file = await camera.take({ seconds, trigger, signal: taking.signal }, (at, seen) => {
      if (at === "ready") return say(`Next: ${label}. Step back.`, [stopButton()]);
      const [, words] = seen ? situation(seen, trigger) : ["", instructions];
      return say(words, [done, stopButton()], seen && isSlow(seen) ? SLOW : "");
    });
    taking = handsFree ? new AbortController() : null;
    const wanted = file && taking && (await approve(file, taking.signal));
    taking = null;
    if (wanted) send(entry, file);
  }

  /** Show the gestures one after the other before the camera, the chosen one first. */
  async function beginHandsFree() {
    let chosen = TO_SHOW.includes(current.standing) ? current : null;
    handsFree = true;
    say("Starting the camera.", []);
    if (!(await camera.start())) return endHandsFree();
    const awake = await navigator.wakeLock?.request("screen").catch(() => null);
    while (handsFree) {
      const entry = chosen ?? next();
      chosen = null;
      if (entry?.standing === "asked") {
        current = entry;
        say("Please answer.", [answers(entry), stopButton()]);
        await changed();
      } else if (entry) await takeOne(entry);
      else if (!busy()) break;
      else {
        say("All gestures are shown. Wait for the answers.", [stopButton()]);
        await changed();
      }
    }
    await awake?.release();
    return endHandsFree();
  }

  function endHandsFree() {
    handsFree = false;
    taking?.abort("drop");
    taking = null;
    camera.off();
    wake();
    advance();
  }

  for (const entry of entries) {
    const known = memory.kept.takes[entry.gesture.label];
    if (known) follow(entry, known);
  }
  advance();
}
