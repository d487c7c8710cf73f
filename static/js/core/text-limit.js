// The longest text of a field, in code points as the server counts; `maxLength` counts UTF-16
// units, of which many scripts' letters and every emoji take two.

// As in gestures/demonstration.py of the core; a test compares them.
export const MAX_DEMONSTRATIONS = 8;
export const MAX_DIVER_LENGTH = 80;

/**
 * The first `most` code points of a text.
 *
 * @param {string} text
 * @param {number} most
 */
export function cut(text, most) {
  const points = [...text];
  return points.length > most ? points.slice(0, most).join("") : text;
}

/**
 * Let a field take `most` code points; a note beside it says when a text was cut.
 *
 * @template {HTMLInputElement | HTMLTextAreaElement} T
 * @param {T} input
 * @param {number} most
 * @returns {T}
 */
export function limit(input, most) {
  const note = document.createElement("small");
  note.className = "cut-note";
  note.setAttribute("role", "alert");
  // In the capturing phase, so that other listeners of the input read the shortened text.
  input.addEventListener(
    "input",
    () => {
      const kept = cut(input.value, most);
      if (kept === input.value) return note.remove();
      input.value = kept;
      note.textContent = `At most ${most} letters: the end was left out.`;
      return input.after(note);
    },
    { capture: true },
  );
  return input;
}
