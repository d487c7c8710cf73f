// Chapters: the files into which a camera splits one recording, which are offered as one clip.

import { ask } from "../core/dialogs.js";
import { byId } from "../core/dom.js";

// Of GoPro, of DJI, and of cameras that begin a file every minute, by its time or its number: what
// comes before the number, the number, and what follows.
const GOPRO = /^(G[HXP])(\d\d)(\d{4}\.\w+)$/i;
const NAMES = [
  GOPRO,
  /^(DJI_)(?:\d{14}_)?(\d{4})((?:_[A-Z])?\.\w+)$/i,
  /^(.*?)(\d{8}[-_]?\d{6})(\.(?:ts|mp4))$/i,
  /^(.*?)(\d{2,})(\.ts)$/i,
];
// Of programs that cut any format; two files of this kind may as well be two takes.
const PIECE = /^(.*?)(\d{2,})(\.\w+)$/;

const TIME = /^(....)(..)(..)[-_]?(..)(..)(..)$/;
const LONGEST = 10; // minutes of one chapter, where names tell times.
const ALIKE = 1.25; // most times the size of another one, where only numbers tell chapters.

/** @typedef {{ file: File, recording: string, at: number, step: number, sure: boolean, fewest: number }} Chapter */

/**
 * @param {File} file
 * @returns {Chapter[]}
 */
function chapterOf(file) {
  const plain = file.name.replace(/^GOPR(?=\d{4}\.)/i, "GP00"); // its first chapter until 2017
  const known = NAMES.map((each) => plain.match(each)).find(Boolean);
  const match = known ?? plain.match(PIECE);
  if (!match) return [];
  const [, before, digits, after] = match;
  const minutes = Date.parse(digits.replace(TIME, "$1-$2-$3T$4:$5:$6Z")) / 60000;
  const [at, step] = TIME.test(digits) ? [minutes, LONGEST] : [Number(digits), 1];
  const sure = GOPRO.test(plain);
  return [{ file, recording: before + after, at, step, sure, fewest: known ? 2 : 3 }];
}

/**
 * Whether a chapter follows another one: by the next number, or by whole minutes.
 *
 * @param {Chapter} one
 * @param {Chapter} next
 */
function follows(one, next) {
  const step = next.at - one.at;
  const near = step > 0 && step <= one.step && Math.abs(step - Math.round(step)) < 0.05;
  return near && one.recording === next.recording;
}

/**
 * Whether all but the last are of about the same size, and the last is no larger: a camera goes on
 * in another file at a size or a time, and takes differ.
 *
 * @param {File[]} files
 */
function alike(files) {
  const sizes = files.map(({ size }) => size);
  return Math.max(...sizes) <= ALIKE * Math.min(...sizes.slice(0, -1));
}

/**
 * The files of each recording of several chapters, in order.
 *
 * @param {File[]} files
 */
export function chaptersAmong(files) {
  const named = files.flatMap(chapterOf);
  named.sort((a, b) => a.recording.localeCompare(b.recording) || a.at - b.at);
  const first = named.filter((each, index) => !index || !follows(named[index - 1], each));
  const begins = [...first.map((each) => named.indexOf(each)), named.length];
  return first
    .map((each, index) => ({
      sure: each.sure,
      fewest: each.fewest,
      run: named.slice(begins[index], begins[index + 1]).map(({ file }) => file),
    }))
    .filter(({ sure, fewest, run }) => run.length >= fewest && (sure || alike(run)))
    .map(({ run }) => run);
}

/**
 * Ask whether chapters become one clip; resolves to the files to send, with fields of the upload.
 *
 * @param {File[]} files
 * @returns {Promise<{ file: File, fields: Record<string, string> }[]>}
 */
export async function offerToJoin(files) {
  let sent = files.map((file) => ({ file, fields: {} }));
  for (const chapters of chaptersAmong(files)) {
    const [{ name: first, lastModified }, { name: last }] = [chapters[0], ...chapters.slice(-1)];
    if (byId("dialog").open) break;
    const joins = await ask({
      title: `${chapters.length} chapters of one recording: join them?`,
      text: `${first} to ${last} become one clip, without sound.`,
      fields: [],
      action: "Join them",
      refusal: "Keep them apart",
      submit: () => true,
    });
    if (!joins) continue;
    const name = `${first.replace(/\.\w+$/, "")}-${last}`.replace(/\.ts$/i, ".mp4");
    const file = new File(chapters, name, { lastModified });
    const fields = { chapters: chapters.map(({ size }) => size).join(",") };
    sent = sent.filter((each) => !chapters.includes(each.file));
    sent.push({ file, fields });
  }
  return sent;
}
