// Requesting the preview of a draft, shortly after its last change; only the newest answer counts.

import * as api from "../core/api.js";

/** @import { Outlook, Preview, Schemas } from "../core/types.d.ts" */

const SETTLED = 120; // ms without a change: dragging a slider makes many.

/**
 * Return a function that requests a preview: `shown(preview, null)` is called with the gesture,
 * then `shown(preview, estimate)` with its estimated rates too; `failed(error)` if either fails.
 *
 * @param {{ shown: (preview: Preview, estimate: Outlook | null) => void, failed: (error: Error) => void }} answers
 * @returns {(language: string, body: Schemas["PreviewRequest"]) => void}
 */
export function previewing({ shown, failed }) {
  let timer = 0;
  let newest = "";
  return (language, body) => {
    const asked = JSON.stringify([language, body]);
    if (asked === newest) return;
    newest = asked;
    clearTimeout(timer);
    timer = setTimeout(async () => {
      try {
        const preview = await api.languages.preview(language, body);
        if (asked !== newest) return;
        shown(preview, null);
        if (preview.problem) return;
        const estimate = await api.languages.previewHealth(language, body);
        if (asked === newest) shown(preview, estimate);
      } catch (error) {
        if (asked !== newest) return;
        newest = ""; // The same request may succeed later.
        failed(error);
      }
    }, SETTLED);
  };
}
