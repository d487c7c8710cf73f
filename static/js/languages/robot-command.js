// The command of a gesture or phrase: words, or a JSON object.

/**
 * A command as it is written in a text field.
 *
 * @param {unknown} command
 */
export const written = (command) =>
  command === null || command === undefined
    ? ""
    : typeof command === "string"
      ? command
      : JSON.stringify(command, null, 2);

/**
 * Parse a typed command: `{ command, kind }`, or `{ problem }`. Text that begins like an object
 * must be one, so that an object with a missing brace does not reach the robot as words.
 *
 * @param {string} text
 * @returns {{ command?: string | Record<string, unknown> | null, kind?: string, problem?: string }}
 */
export function read(text) {
  const trimmed = text.trim();
  if (!trimmed) return { command: null, kind: "none" };
  if (!/^[{[]/.test(trimmed)) return { command: trimmed, kind: "words" };
  try {
    const command = JSON.parse(trimmed);
    if (Array.isArray(command))
      return { problem: 'A JSON command is an object: put the list in one, {"steps": [\u2026]}.' };
    return { command, kind: "a JSON object" };
  } catch (error) {
    return {
      problem: `This begins like a JSON object but is none: ${error.message}. Correct it, or begin with a word.`,
    };
  }
}
