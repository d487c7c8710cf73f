// Copying to the clipboard.

import { toast } from "./toasts.js";

/**
 * Copy a text and confirm it in a toast with `title` and `detail`.
 *
 * @param {string} text
 * @param {string} title
 * @param {string} [detail]
 */
export async function copy(text, title, detail = text) {
  try {
    await navigator.clipboard.writeText(text);
    toast(title, detail);
  } catch {
    toast(
      "Could not copy",
      `The browser does not let this page use the clipboard; select and copy it yourself: ${text}`,
      { kind: "error" },
    );
  }
}

/** Copy the page's address, which restores all that is shown. */
export const copyLink = () =>
  copy(
    location.href,
    "Link copied",
    ["localhost", "127.0.0.1", "[::1]"].includes(location.hostname)
      ? "It shows the same clip, take, frame, language and panel again, on this computer: the studio is served to no other one."
      : "It shows the same clip, take, frame, language and panel to everyone who reaches this studio.",
  );
