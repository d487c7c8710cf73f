// Formatting numbers, durations, moments and names.

/**
 * @param {number} count
 * @returns {string}
 */
export function bytes(count) {
  if (count < 1000) return `${count} B`;
  if (count < 1e6) return `${Math.round(count / 1e3)} kB`;
  if (count < 1e9) return `${(count / 1e6).toFixed(1)} MB`;
  return `${(count / 1e9).toFixed(2)} GB`;
}

/**
 * Seconds in a clip, to the hundredth: a frame lasts three or four of them.
 *
 * @param {number} seconds
 */
export const moment = (seconds) => `${seconds.toFixed(2)} s`;

/**
 * A duration, in whatever unit is readable.
 *
 * @param {number} seconds
 * @returns {string}
 */
export function duration(seconds) {
  if (seconds < 60) return `${seconds < 10 ? seconds.toFixed(1) : Math.round(seconds)} s`;
  const whole = Math.round(seconds);
  return `${Math.floor(whole / 60)} min ${String(whole % 60).padStart(2, "0")} s`;
}

/**
 * An estimated duration: in whole minutes, or in tens of seconds.
 *
 * @param {number} seconds
 */
export const about = (seconds) =>
  seconds < 55
    ? `about ${Math.max(10, 10 * Math.round(seconds / 10))} s`
    : `about ${Math.round(seconds / 60)} min`;

/**
 * @param {number} seconds
 * @returns {string}
 */
export function timeLeft(seconds) {
  if (seconds < 1) return "almost done";
  return `${seconds < 60 ? `${Math.ceil(seconds)} s` : duration(seconds)} left`;
}

const RELATIVE = new Intl.RelativeTimeFormat("en", { numeric: "auto" });
/** @type {[Intl.RelativeTimeFormatUnit, number][]} */
const UNITS = [
  ["year", 31536000],
  ["month", 2592000],
  ["day", 86400],
  ["hour", 3600],
  ["minute", 60],
];

/**
 * A past moment relative to now.
 *
 * @param {string | number} moment
 * @returns {string}
 */
export function ago(moment) {
  const seconds = (new Date(moment).getTime() - Date.now()) / 1000;
  const [unit, length] = UNITS.find(([, each]) => Math.abs(seconds) >= each) ?? [null, 1];
  return unit ? RELATIVE.format(Math.round(seconds / length), unit) : "just now";
}

/**
 * A date and time in the reader's locale.
 *
 * @param {string} moment
 */
export const dateAndTime = (moment) =>
  new Date(moment).toLocaleString(undefined, { dateStyle: "medium", timeStyle: "short" });

/**
 * An identifier, such as a landmark or a voter, in words.
 *
 * @param {string} identifier
 */
export const readable = (identifier) => identifier.replaceAll("_", " ");

/**
 * @param {number} count
 * @param {string} noun
 */
export const plural = (count, noun) => `${count} ${noun}${count === 1 ? "" : "s"}`;

/**
 * A share in [0, 1] as a percentage; a small share is "<1 %", so that it is not taken for zero.
 *
 * @param {number} share
 */
export const percent = (share) =>
  share > 0 && share < 0.005 ? "<1 %" : `${(100 * share).toFixed(0)} %`;

/**
 * The question which of two gestures was meant.
 *
 * @param {string[]} pair
 */
export const askWhich = (pair) => `${pair.join(" or ")}?`;
