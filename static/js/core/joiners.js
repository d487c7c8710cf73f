// Joiners: zero-width characters that belong to the spelling of Persian, Hindi or Sinhala words.

/**
 * A text to compare by: two that differ in joiners alone look alike.
 *
 * @param {string} text
 */
export const withoutJoiners = (text) => text.replace(/[\u200c\u200d]/g, "");
