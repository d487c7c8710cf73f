// The results of the test with clips: which takes count, and the table as CSV.

const Z = 1.96; // Standard deviations of a 95 % interval.

/** Whether a take is, for the larger part, the demonstration of a gesture. */
const demonstrates = ({ clip_id: clip, start, end }, gestures) =>
  gestures.some(({ source }) => {
    if (source?.clip_id !== clip) return false;
    return Math.min(end, source.end) - Math.max(start, source.start) > (end - start) / 2;
  });

/** Wilson's 95 % interval of a share (Wilson 1927), as `{ rate, low, high }`. */
export function intervalOf(right, count) {
  const rate = right / count;
  const middle = (rate + Z ** 2 / (2 * count)) / (1 + Z ** 2 / count);
  const half =
    (Z / (1 + Z ** 2 / count)) * Math.sqrt((rate * (1 - rate)) / count + (Z / (2 * count)) ** 2);
  return { rate, low: Math.max(0, middle - half), high: Math.min(1, middle + half) };
}

/** The rate of each label: `{ label, right, count, rate, low, high }`, the lowest first. */
export function ratesOf(takes) {
  const labels = [...new Set(takes.map(({ expected }) => expected))];
  return labels
    .map((label) => {
      const own = takes.filter(({ expected }) => expected === label);
      const right = own.filter((take) => take.right).length;
      return { label, right, count: own.length, ...intervalOf(right, own.length) };
    })
    .sort((one, other) => one.rate - other.rate);
}

/**
 * The newest recognition of each labelled take, by the language's profile and without trials.
 * `demonstration` marks those that count nothing: a demonstration is recognised by construction.
 */
export function testedOf(recognitions, clips, profile, gestures = []) {
  const names = new Map(clips.map(({ id, name }) => [id, name]));
  const newest = new Map();
  for (const each of recognitions) {
    const key = `${each.clip_id} ${each.start}`;
    const counts = each.profile === profile && !each.tuning && !each.trial;
    if (counts && !newest.has(key)) newest.set(key, each);
  }
  return [...newest.values()]
    .filter((each) => each.expected !== null && names.has(each.clip_id))
    .map((each) => ({
      ...each,
      clip: names.get(each.clip_id),
      right: each.label === each.expected,
      demonstration: demonstrates(each, gestures),
    }))
    .sort(
      (one, other) =>
        one.clip.localeCompare(other.clip, "en", { numeric: true }) || one.start - other.start,
    );
}

const COLUMNS = [
  "clip",
  "start",
  "end",
  "expected",
  "label",
  "nearest",
  "confidence",
  "right",
  "revision",
  "id",
];

/** A value as CSV (RFC 4180); a text that a spreadsheet would calculate is marked as text. */
function field(value) {
  const text =
    typeof value === "string" ? value.replace(/^[=+\-@\t\r]/, "'$&") : String(value ?? "");
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

/** The table of takes as a CSV file. */
export const csvOf = (takes) =>
  [COLUMNS, ...takes.map((take) => COLUMNS.map((name) => take[name]))]
    .map((row) => `${row.map(field).join(",")}\r\n`)
    .join("");
