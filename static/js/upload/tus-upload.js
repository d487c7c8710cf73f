// Resumable uploads (tus 1.0.0): they survive a lost connection, a reload and a server's restart.

import { ApiError, BASE, isAway, problemOf, unreachable } from "../core/server.js";
import { browserStore } from "../core/browser-store.js";

/** @import { Stand } from "../core/types.d.ts" */

const PLACE = `${BASE}/uploads`;
const VERSION = { "Tus-Resumable": "1.0.0" };
const PART = 8 * 2 ** 20; // bytes of one request, and at most sent again after a break.
const FIRST_PAUSE = 500; // ms before the first retry; the pause doubles with each further one,
const LONGEST_PAUSE = 8000; // up to this.

const cancelled = () =>
  new ApiError({ title: "Cancelled", detail: "The upload was cancelled.", code: "cancelled" }, 0);

/**
 * The key under which a file's upload address is stored, to resume it after a reload.
 *
 * @param {File} file
 */
const keyOf = ({ name, size, lastModified }) => `osg-studio.upload.${size}.${lastModified}.${name}`;

/**
 * @param {File} file
 * @param {string | null} place
 */
const keep = (file, place) => browserStore.set(keyOf(file), place);

/**
 * @param {string} method
 * @param {string} place
 * @param {Record<string, string>} [headers]
 */
async function ask(method, place, headers = {}) {
  let response;
  try {
    response = await fetch(place, { method, headers: { ...VERSION, ...headers } });
  } catch {
    throw unreachable();
  }
  if (!response.ok) throw new ApiError(await problemOf(response), response.status);
  return response.headers;
}

/**
 * The progress of an upload, from the headers of an answer.
 *
 * @param {string} place
 * @param {{ get: (name: string) => string | null }} headers
 */
export const standOf = (place, headers) => ({
  place,
  offset: Number(headers.get("Upload-Offset")),
  clip: headers.get("Content-Location")?.split("/").at(-1) ?? null,
});

/** @param {string} text */
const base64 = (text) => btoa(String.fromCharCode(...new TextEncoder().encode(text)));

/**
 * The `Upload-Metadata` of a file: names, each with its text in base64 of UTF-8.
 *
 * @param {string} name
 * @param {Record<string, string>} fields
 */
export const metadataOf = (name, fields) =>
  Object.entries({ filename: name, ...fields })
    .map(([key, text]) => `${key} ${base64(text)}`)
    .join(",");

/**
 * @param {File} file
 * @param {Record<string, string>} fields
 */
async function begin(file, fields) {
  const headers = await ask("POST", PLACE, {
    "Upload-Length": String(file.size),
    "Upload-Metadata": metadataOf(file.name, fields),
  });
  const place = `${PLACE}/${headers.get("Location")?.split("/").at(-1)}`;
  keep(file, place);
  return { place, offset: 0, clip: null };
}

/**
 * Ask how much of a file the server has; begin anew if it has none.
 *
 * @param {File} file
 * @param {Record<string, string>} fields
 */
async function resume(file, fields) {
  const place = browserStore.get(keyOf(file));
  if (!place) return begin(file, fields);
  try {
    return standOf(place, await ask("HEAD", place));
  } catch (error) {
    if (error.status !== 404) throw error;
    return begin(file, fields);
  }
}

/**
 * Send the next part, by XMLHttpRequest: `fetch` does not report an upload's progress.
 *
 * @param {XMLHttpRequest} call
 * @param {File} file
 * @param {Stand} at
 * @param {(loaded: number) => void} onProgress
 * @returns {Promise<Stand>}
 */
function send(call, file, { place, offset }, onProgress) {
  const sent = new Promise((resolve, reject) => {
    call.upload.onprogress = ({ loaded }) => onProgress(offset + loaded);
    call.onload = async () => {
      if (call.status < 300)
        return resolve(standOf(place, { get: (name) => call.getResponseHeader(name) }));
      const problem = await problemOf(new Response(call.responseText));
      return reject(new ApiError(problem, call.status));
    };
    call.onerror = () => reject(unreachable());
    call.onabort = () => reject(cancelled());
  });
  call.open("PATCH", place);
  for (const [name, value] of Object.entries({
    ...VERSION,
    "Upload-Offset": String(offset),
    "Content-Type": "application/offset+octet-stream",
  }))
    call.setRequestHeader(name, value);
  call.send(file.slice(offset, offset + PART));
  return sent;
}

/**
 * Whether a retry may help: the server was unreachable, or the offsets disagree.
 *
 * @param {{ code?: string, status?: number }} error
 */
export const mayGoOn = (error) =>
  isAway(error) ||
  [502, 503, 504].includes(error.status ?? 0) ||
  ["upload_offset", "upload_broken_off"].includes(error.code ?? "");

/**
 * Upload a file. `fields` are its metadata, named as in the API.
 * `onProgress(loaded, away)` gets the bytes received, and whether the server is unreachable at
 * present. Returns `{ done, cancel }`; `done` resolves to the clip's id.
 *
 * @param {File} file
 * @param {Record<string, string>} fields
 * @param {(loaded: number, away: boolean) => void} onProgress
 */
export function upload(file, fields, onProgress) {
  /** @type {XMLHttpRequest | null} */
  let call = null;
  /** @type {string | null} */
  let place = null;
  let came = 0; // bytes, as far as is known
  /** @type {() => void} */
  let wake = () => {};
  let gone = false;

  async function run() {
    /** @type {Stand | null} */
    let at = null;
    let pause = FIRST_PAUSE;
    while (!at?.clip) {
      if (gone) throw cancelled();
      try {
        at ??= await resume(file, fields);
        ({ place } = at);
        came = at.offset;
        if (at.clip) break;
        call = new XMLHttpRequest();
        at = await send(call, file, at, (loaded) => onProgress(loaded, false));
        pause = FIRST_PAUSE;
      } catch (error) {
        if (!mayGoOn(error)) throw error;
        onProgress(came, true);
        at = null;
        /** @type {Promise<void>} */
        const waited = new Promise((resolve) => {
          wake = resolve;
          setTimeout(resolve, pause);
        });
        await waited;
        pause = Math.min(LONGEST_PAUSE, 2 * pause);
      }
    }
    keep(file, null);
    return at.clip;
  }

  return {
    done: run(),
    cancel() {
      gone = true;
      wake();
      call?.abort();
      keep(file, null);
      // Without an answer, the server drops the upload a day later.
      if (place) ask("DELETE", place).catch(() => {});
    },
  };
}
