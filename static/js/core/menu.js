// A menu: a button that opens a short list of commands.

import { elementOf, html, iconOf } from "../templates.js";

/** @import { MenuItem } from "./types.d.ts" */

/** @type {{ menu: HTMLDetailsElement } | null} */
let open = null;

/** @param {boolean} [back] */
function close(back = false) {
  if (!open) return;
  const { menu } = open;
  open = null;
  menu.open = false;
  if (back) menu.querySelector("summary")?.focus();
}

addEventListener("click", (event) => {
  if (open && !open.menu.contains(/** @type {Node} */ (event.target))) close();
});

/**
 * Make a menu. `items` are `{ text, run }`, or `{ text, href }` for a file to download; the arrow
 * keys walk through them.
 *
 * @param {string} label
 * @param {MenuItem[]} items
 * @returns {HTMLDetailsElement}
 */
export function menu(label, items) {
  /** @param {MenuItem} item */
  const entry = ({ text, run, href, writes }) => {
    const choose = () => {
      close(!href);
      run?.();
    };
    return href
      ? html`<a href=${href} download @click=${choose}>${text}</a>`
      : html`<button type="button" ?data-writes=${writes} @click=${choose}>${text}</button>`;
  };
  const element = /** @type {HTMLDetailsElement} */ (
    elementOf(
      html`<details class="menu">
        <summary class="button quiet icon" aria-label=${label} title=${label}>
          ${iconOf("more")}
        </summary>
        <div class="menu-list">${items.map(entry)}</div>
      </details>`,
    )
  );
  element.ontoggle = () => {
    if (element.open) {
      if (open?.menu !== element) close();
      open = { menu: element };
    } else if (open?.menu === element) open = null;
  };
  element.onkeydown = (event) => {
    if (event.key === "Escape" && element.open) {
      event.preventDefault();
      close(true);
    }
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (!step || !element.open) return;
    event.preventDefault();
    const entries = /** @type {HTMLElement[]} */ ([...element.querySelectorAll(":enabled, a")]);
    const at = entries.findIndex((each) => each === document.activeElement);
    entries[(at + step + entries.length) % entries.length].focus();
  };
  return element;
}
