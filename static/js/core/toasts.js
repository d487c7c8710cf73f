// Toasts: short messages with what happened, why, and what to do next.

import { elementOf, html, iconButtonOf, nothing } from "../templates.js";
import { byId } from "./dom.js";

/** Milliseconds. */
const SHOWN_FOR = { info: 6000, error: 15000, offer: 15000 };

/**
 * Reserve the height of the messages, so that they cover no control that is used next.
 *
 * @param {HTMLElement} box
 */
function reserve(box) {
  const height = box.offsetHeight;
  document.documentElement.style.setProperty("--toasts", `${height}px`);
  const { activeElement } = document;
  if (height && activeElement !== document.body)
    activeElement?.scrollIntoView({ block: "nearest" });
}

/** Keep the reserved height up to date. */
export function reserveToasts() {
  const box = byId("toasts");
  new ResizeObserver(() => reserve(box)).observe(box, { box: "border-box" });
}

/**
 * Show a message. `action` is `{ label, run }`: an "Undo", or a remedy. It replaces an older
 * message with the same text. Returns its element.
 *
 * @param {string} title
 * @param {string} [detail]
 * @param {{ kind?: "info" | "error", action?: { label: string, run: () => void } | null }} [options]
 * @returns {HTMLElement}
 */
export function toast(title, detail = "", { kind = "info", action = null } = {}) {
  const box = byId("toasts");
  for (const other of [...box.children]) if (other.dataset.text === title + detail) other.remove();
  const close = () => element.remove();
  const act = () => {
    close();
    action?.run();
  };
  const element = elementOf(
    html`<div class="toast ${kind}" role=${kind === "error" ? "alert" : "status"}>
      <div><b>${title}</b>${detail ? html`<p>${detail}</p>` : nothing}</div>
      ${action ? html`<button type="button" @click=${act}>${action.label}</button>` : nothing}
      ${iconButtonOf("close", "Dismiss", close)}
    </div>`,
  );
  element.dataset.text = title + detail;
  box.append(element);
  removeAfter(element, SHOWN_FOR[action ? "offer" : kind]);
  return element;
}

/**
 * Remove a message after some milliseconds, but not while the pointer or the focus is on it.
 *
 * @param {HTMLElement} element
 * @param {number} milliseconds
 */
function removeAfter(element, milliseconds) {
  let timer = 0;
  const hold = () => clearTimeout(timer);
  const release = () => {
    hold();
    timer = setTimeout(() => element.remove(), milliseconds);
  };
  release();
  for (const event of ["pointerenter", "focusin"]) element.addEventListener(event, hold);
  for (const event of ["pointerleave", "focusout"]) element.addEventListener(event, release);
}

/**
 * Show what went wrong.
 *
 * @param {any} error
 * @param {string} [doing]
 */
export function complain(error, doing) {
  if (error.code === "cancelled") return;
  if (!("status" in error)) console.error(error);
  toast(doing ? `${doing} failed` : (error.title ?? "Something went wrong"), error.message, {
    kind: "error",
  });
}

/**
 * Run a task; an error is shown as a toast, and the result is then null.
 *
 * @template T
 * @param {string} doing
 * @param {() => T | Promise<T>} task
 * @returns {Promise<T | null>}
 */
export async function attempt(doing, task) {
  try {
    return await task();
  } catch (error) {
    complain(error, doing);
    return null;
  }
}
