// The results of the test with clips: which takes count, and the table as CSV.

/** The newest recognition of each labelled take, by the language's profile and without trials. */
export function testedOf(recognitions, clips, profile) {
  const names = new Map(clips.map(({ id, name }) => [id, name]));
  const newest = new Map();
  for (const each of recognitions) {
    const key = `${each.clip_id} ${each.start}`;
    if (each.profile === profile && !each.tuning && !newest.has(key)) newest.set(key, each);
  }
  return [...newest.values()]
    .filter((each) => each.expected !== null && names.has(each.clip_id))
    .map((each) => ({
      ...each,
      clip: names.get(each.clip_id),
      right: each.label === each.expected,
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
