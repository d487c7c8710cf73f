// Joiners: zero-width characters that belong to the spelling of Persian, Hindi or Sinhala words.

/**
 * The text without joiners, for comparisons: texts that differ only in joiners look alike.
 *
 * @param {string} text
 */
export const withoutJoiners = (text) => text.replace(/[\u200c\u200d]/g, "");
