// The studio's HTTP API. Every failure becomes an ApiError that can be shown as it is.

import createClient from "../../vendor/openapi-fetch/index.mjs";
import { ApiError, BASE, problemOf, unreachable } from "./server.js";

export { beside, isAway } from "./server.js";

/** @import { paths } from "./api-schema.d.ts" */
/** @import { Clip, ClipPage, Schemas, Server } from "./types.d.ts" */

const CLIPS_OF_A_PAGE = 500; // Half a megabyte; takes the server 50 ms.

const client = createClient({ baseUrl: BASE, fetch: (request) => fetch(request) });
const { GET, POST, PUT, PATCH, DELETE, use } = /** @type {Server} */ (/** @type {any} */ (client));

use({
  // Chromium's cache delays a change, by up to 20 s, until a read of the same address has ended;
  // without this option a running check could not be cancelled.
  onRequest: ({ request }) =>
    request.method === "GET" ? request : new Request(request, { cache: "no-store" }),
  onResponse: async ({ response }) => {
    if (!response.ok) throw new ApiError(await problemOf(response), response.status);
  },
  onError: unreachable,
});

/**
 * What the server answers; every failure is thrown before.
 *
 * @template T
 * @param {Promise<{ data: T }>} request
 */
const answer = async (request) => (await request).data;

/**
 * The parts of an address: what its path names, and its query.
 *
 * @template P
 * @template [Q=undefined]
 * @param {P} path
 * @param {Q} [query]
 */
const at = (path, query) => ({ params: { path, query: /** @type {Q} */ (query) } });

/**
 * The address of a language that a change was made from; any other revision is refused.
 *
 * @template [Q=undefined]
 * @template [P={}]
 * @param {{ id: string, revision?: number }} language
 * @param {Q} [query]
 * @param {P} [path] what else the path names
 */
const from = ({ id, revision }, query, path) => ({
  ...at({ language_id: id, .../** @type {P} */ (path) }, query),
  headers: revision === undefined ? {} : { "If-Match": `"${revision}"` },
});

/**
 * The query of what a language's trigger cuts out of a clip.
 *
 * @param {string | null | undefined} language null: what the salute does
 * @param {boolean | undefined} soFar
 */
const triggered = (language, soFar) => ({
  so_far: soFar || undefined,
  language_id: language || undefined,
});

const escaped = encodeURIComponent;

/** @typedef {{ id: string, revision: number }} Revised */

export const session = {
  get: () => answer(GET("/session")),
  end: () => answer(DELETE("/session")),
};

export const audit = {
  /** @param {paths["/audit"]["get"]["parameters"]["query"]} query */
  list: (query) => answer(GET("/audit", { params: { query } })),
};

/**
 * The address of a clip's pictures, another one once they are turned: browsers keep them.
 *
 * @param {Pick<Clip, "id"> & Partial<Clip>} clip
 * @param {"video" | "poster" | "filmstrip"} which
 */
const picture = (clip, which) =>
  `${BASE}/clips/${escaped(clip.id)}/${which}${clip.turn ? `?turned=${clip.turn}` : ""}`;

export const clips = {
  /**
   * A page of the clips, newest first: those after a clip, those whose name contains `q`, those in
   * a state, or those of some ids.
   *
   * @param {paths["/clips"]["get"]["parameters"]["query"]} [which]
   * @returns {Promise<ClipPage>}
   */
  page: async (which) => {
    const query = { limit: CLIPS_OF_A_PAGE, ...which };
    const { data, response } = await GET("/clips", { params: { query } });
    return {
      clips: data,
      more: response.headers.has("Link"),
      total: Number(response.headers.get("X-Total-Count")),
    };
  },
  /** @param {string} clip_id @param {string | null} [by] @param {boolean} [soFar] */
  timeline: (clip_id, by, soFar) =>
    answer(GET("/clips/{clip_id}/timeline", at({ clip_id }, triggered(by, soFar)))),
  /** @param {Clip} clip */
  filmstrip: (clip) => picture(clip, "filmstrip"),
  /** @param {string} clip_id */
  get: (clip_id) => answer(GET("/clips/{clip_id}", at({ clip_id }))),
  /** @param {string} clip_id */
  poses: (clip_id) => answer(GET("/clips/{clip_id}/poses", at({ clip_id }))),
  /** @param {string} clip_id @param {string | null} [by] @param {boolean} [soFar] */
  takes: (clip_id, by, soFar) =>
    answer(GET("/clips/{clip_id}/takes", at({ clip_id }, triggered(by, soFar)))),
  /** @param {string} clip_id */
  remove: (clip_id) => answer(DELETE("/clips/{clip_id}", at({ clip_id }))),
  /** @param {string} clip_id */
  restore: (clip_id) => answer(POST("/clips/{clip_id}/restore", at({ clip_id }))),
  /** @param {string} clip_id */
  retry: (clip_id) => answer(POST("/clips/{clip_id}/jobs", at({ clip_id }))),
  /** @param {string} clip_id @param {string} topic */
  chooseTopic: (clip_id, topic) =>
    answer(POST("/clips/{clip_id}/topic", { ...at({ clip_id }), body: { topic } })),
  /** @param {string} clip_id @param {90 | 180 | 270} degrees */
  turn: (clip_id, degrees) =>
    answer(POST("/clips/{clip_id}/turn", { ...at({ clip_id }), body: { degrees } })),
  /** @param {Clip} clip */
  poster: (clip) => picture(clip, "poster"),
  /**
   * Write a session on the server; its progress comes as events of that `name`.
   *
   * @param {string} clip_id @param {string} id @param {AbortSignal} signal
   */
  writeSession: (clip_id, id, signal) =>
    answer(POST("/clips/{clip_id}/session.mcap", { ...at({ clip_id }), body: { id }, signal })),
  /**
   * The address from which the browser saves a session that was written.
   *
   * @param {string} clip @param {string} name
   */
  session: (clip, name) => `${BASE}/clips/${escaped(clip)}/session.mcap?export=${escaped(name)}`,
  /** @param {Pick<Clip, "id"> & Partial<Clip>} clip */
  video: (clip) => picture(clip, "video"),
};

export const jobs = {
  /** @param {string} job_id */
  cancel: (job_id) => answer(DELETE("/jobs/{job_id}", at({ job_id }))),
};

export const samples = {
  list: () => answer(GET("/samples")),
  /** @param {string} name */
  add: (name) => answer(POST("/samples", { body: { name } })),
  languages: () => answer(GET("/samples/languages")),
  /** @param {string} name */
  addLanguage: (name) => answer(POST("/samples/languages", { body: { name } })),
};

export const languages = {
  list: () => answer(GET("/languages")),
  /** @param {string} language_id */
  get: (language_id) => answer(GET("/languages/{language_id}", at({ language_id }))),
  /** @param {string} name */
  create: (name) => answer(POST("/languages", { body: { name } })),
  /** @param {Revised} language @param {Schemas["LanguageChange"]} body */
  change: (language, body) =>
    answer(PATCH("/languages/{language_id}", { ...from(language), body })),
  /** @param {Revised} language @param {Schemas["TriggerDraft"]} body */
  setTrigger: (language, body) =>
    answer(PUT("/languages/{language_id}/trigger", { ...from(language), body })),
  /** @param {string} language_id */
  duplicate: (language_id) =>
    answer(POST("/languages/{language_id}/duplicate", at({ language_id }))),
  /** @param {string} language_id */
  revisions: (language_id) =>
    answer(GET("/languages/{language_id}/revisions", at({ language_id }))),
  /** @param {string} language_id @param {number | null} older @param {number} newer */
  compare: (language_id, older, newer) =>
    answer(GET("/languages/{language_id}/comparison", at({ language_id }, { newer, older }))),
  /** @param {Revised} language @param {string[]} gesture @param {boolean} paused */
  phrases: ({ id, revision }, gesture, paused) => {
    /** @type {paths["/languages/{language_id}/phrases"]["get"]["parameters"]["query"]} */
    const asked = { revision, gesture, then: paused ? "pause" : "wait" };
    return answer(GET("/languages/{language_id}/phrases", at({ language_id: id }, asked)));
  },
  /** @param {string} language_id @param {number} revision @returns {Promise<any>} a HealthReport */
  check: (language_id, revision) =>
    answer(GET("/languages/{language_id}/check", at({ language_id }, { revision }))),
  /** @param {string} language_id @param {number} revision */
  cancelCheck: (language_id, revision) =>
    answer(DELETE("/languages/{language_id}/check", at({ language_id }, { revision }))),
  /** @param {string} language_id @param {{ one: string, other: string, revision: number }} pair */
  contrast: (language_id, pair) =>
    answer(GET("/languages/{language_id}/contrast", at({ language_id }, pair))),
  /** @param {Schemas["ChoiceRequest"]} body @param {AbortSignal} signal */
  choose: (body, signal) => answer(POST("/languages/choice", { body, signal })),
  /** @param {Revised} language @param {Schemas["ReplacementsRequest"]} body @param {AbortSignal} signal */
  replacements: ({ id, revision }, body, signal) => {
    const place = at({ language_id: id }, { revision });
    return answer(POST("/languages/{language_id}/replacements", { ...place, body, signal }));
  },
  /** @param {Revised} language @param {Schemas["ReplacementDraft"]} body */
  replaceGesture: (language, body) =>
    answer(PUT("/languages/{language_id}/replacements", { ...from(language), body })),
  /** @param {string} language @param {string} label @param {number} revision */
  image: (language, label, revision) =>
    `${BASE}/languages/${escaped(language)}/gestures/image?label=${escaped(label)}&revision=${revision}&marks=true`,
  /** @param {string} language_id */
  restore: (language_id) => answer(POST("/languages/{language_id}/restore", at({ language_id }))),
  /** @param {{ id: string, revision?: number }} language */
  remove: (language) => answer(DELETE("/languages/{language_id}", from(language))),
  /** @param {string} name @param {string} body the file as it is */
  import: (name, body) =>
    answer(
      POST("/languages/import", {
        params: { query: { name } },
        body: /** @type {any} */ (body),
        bodySerializer: (text) => text,
      }),
    ),
  /** @param {Revised} language @param {number} revision */
  revert: (language, revision) =>
    answer(POST("/languages/{language_id}/revert", { ...from(language), body: { revision } })),
  /** @param {string} language_id @param {Schemas["PreviewRequest"]} body */
  preview: (language_id, body) =>
    answer(
      POST("/languages/{language_id}/preview", { ...at({ language_id }, { marks: true }), body }),
    ),
  /** @param {string} language_id @param {Schemas["PreviewRequest"]} body */
  previewHealth: (language_id, body) =>
    answer(POST("/languages/{language_id}/preview/health", { ...at({ language_id }), body })),
  /** @param {string} language_id @param {string} label */
  demonstration: (language_id, label) =>
    answer(GET("/languages/{language_id}/gestures/demonstration", at({ language_id }, { label }))),
  /** @param {Revised} language @param {Schemas["GestureDraft"]} body */
  addGesture: (language, body) =>
    answer(POST("/languages/{language_id}/gestures", { ...from(language), body })),
  /** @param {Revised} language @param {Schemas["GestureDraft"][]} gestures */
  addGestures: (language, gestures) => {
    const wanted = { ...from(language), body: { gestures } };
    return answer(POST("/languages/{language_id}/gestures/batch", wanted));
  },
  /** @param {Revised} language @param {string} label @param {Schemas["GestureChange"]} body */
  changeGesture: (language, label, body) =>
    answer(PATCH("/languages/{language_id}/gestures", { ...from(language, { label }), body })),
  /** @param {Revised} language @param {string} label */
  removeGesture: (language, label) =>
    answer(DELETE("/languages/{language_id}/gestures", from(language, { label }))),
  /** @param {Revised} language @param {Schemas["DemonstrationDraft"]} body */
  addDemonstration: (language, body) =>
    answer(POST("/languages/{language_id}/demonstrations", { ...from(language), body })),
  /** @param {Revised} language @param {string} label @param {number} index */
  removeDemonstration: (language, label, index) =>
    answer(
      DELETE(
        "/languages/{language_id}/demonstrations/{index}",
        from(language, { label }, { index }),
      ),
    ),
  /** @param {string} language_id @param {Schemas["TakeTableRequest"]} body @param {AbortSignal} signal */
  takeTable: (language_id, body, signal) =>
    answer(POST("/languages/{language_id}/take-table", { ...at({ language_id }), body, signal })),
  /** @param {string} language_id */
  exportContents: (language_id) =>
    answer(GET("/languages/{language_id}/export/contents", at({ language_id }))),
  /** @param {string} language_id */
  settings: (language_id) => answer(GET("/languages/{language_id}/settings", at({ language_id }))),
  /** @param {string} language @param {"pdf" | "svg"} format */
  slate: (language, format) => `${BASE}/languages/${escaped(language)}/slate.${format}`,
  /** @param {string} language @param {string} format */
  exportUrl: (language, format) => `${BASE}/languages/${escaped(language)}/export?format=${format}`,
};

const TESTED = "/languages/{language_id}/test-set/{take_id}";

export const testSets = {
  /** @param {string} language_id */
  get: (language_id) => answer(GET("/languages/{language_id}/test-set", at({ language_id }))),
  /** @param {string} language_id @param {Schemas["LabelledTakesDraft"]["takes"]} takes */
  add: (language_id, takes) =>
    answer(POST("/languages/{language_id}/test-set", { ...at({ language_id }), body: { takes } })),
  /** @param {string} language_id @param {string} take_id @param {Schemas["LabelledTakeChange"]} body */
  label: (language_id, take_id, body) =>
    answer(PATCH(TESTED, { ...at({ language_id, take_id }), body })),
  /** @param {string} language_id @param {string} take_id */
  remove: (language_id, take_id) => answer(DELETE(TESTED, at({ language_id, take_id }))),
  /** @param {string} language_id */
  run: (language_id) => answer(POST("/languages/{language_id}/test-set/run", at({ language_id }))),
  /** @param {string} language_id */
  cancel: (language_id) =>
    answer(DELETE("/languages/{language_id}/test-set/run", at({ language_id }))),
};

const INVITATION = "/languages/{language_id}/invitations/{invitation_id}";
const RECEIVED = `${INVITATION}/takes/{take_id}`;

export const invitations = {
  /** @param {string} language_id */
  list: (language_id) => answer(GET("/languages/{language_id}/invitations", at({ language_id }))),
  /** @param {string} language_id @param {Schemas["InvitationDraft"]} body */
  make: (language_id, body) =>
    answer(POST("/languages/{language_id}/invitations", { ...at({ language_id }), body })),
  /** @param {string} language_id @param {string} invitation_id */
  withdraw: (language_id, invitation_id) =>
    answer(DELETE(INVITATION, at({ language_id, invitation_id }))),
  /** @param {string} language_id @param {string} invitation_id @param {string} take_id */
  outlook: (language_id, invitation_id, take_id) =>
    answer(GET(RECEIVED, at({ language_id, invitation_id, take_id }))),
  /** @param {string} language_id @param {string} invitation_id @param {string} take_id @param {"added" | "removed"} status */
  settle: (language_id, invitation_id, take_id, status) =>
    answer(PUT(RECEIVED, { ...at({ language_id, invitation_id, take_id }), body: { status } })),
};

export const practice = {
  /** @param {string} language_id */
  records: (language_id) => answer(GET("/languages/{language_id}/practice", at({ language_id }))),
  /** @param {string} language_id @param {Schemas["PracticeDraft"]} body */
  show: (language_id, body) =>
    answer(POST("/languages/{language_id}/practice", { ...at({ language_id }), body })),
  /** @param {string} language_id @param {string} take_id */
  remove: (language_id, take_id) =>
    answer(DELETE("/languages/{language_id}/practice/{take_id}", at({ language_id, take_id }))),
};

export const recognitions = {
  /** @param {Schemas["RecognitionRequest"]} body */
  create: (body) => answer(POST("/recognitions", { body })),
  /** @param {string} recognition_id */
  get: (recognition_id) => answer(GET("/recognitions/{recognition_id}", at({ recognition_id }))),
  /** @param {string} recognition */
  analysisUrl: (recognition) => `${BASE}/recognitions/${escaped(recognition)}/analysis`,
  /** @param {string} recognition_id */
  images: (recognition_id) =>
    answer(GET("/recognitions/{recognition_id}/images", at({ recognition_id }))),
  /** @param {string} recognition_id @param {string} expected @returns {Promise<any>} an Explanation */
  explain: (recognition_id, expected) =>
    answer(GET("/recognitions/{recognition_id}/explanation", at({ recognition_id }, { expected }))),
};

export const workspaces = {
  /** @param {boolean} dark */
  open: (dark) => answer(POST("/workspaces", { body: { dark } })),
  /** @param {string} workspace_id */
  find: (workspace_id) => answer(GET("/workspaces/{workspace_id}", at({ workspace_id }))),
  /** @param {string} workspace_id @param {Schemas["WorkspaceOptions"]} body */
  change: (workspace_id, body) =>
    answer(PATCH("/workspaces/{workspace_id}", { ...at({ workspace_id }), body })),
  /** @param {string} workspace_id @param {Schemas["ViewRequest"]} body */
  show: (workspace_id, body) =>
    answer(PUT("/workspaces/{workspace_id}/view", { ...at({ workspace_id }), body })),
};

/** Follow everything that changes on the server. */
export const changes = () => new EventSource(`${BASE}/events`);

/**
 * A name, unique across tabs, for a task that the page starts on the server: its progress comes as
 * events of that name. Over plain HTTP browsers have no `crypto.randomUUID`.
 */
export const uniqueId = () =>
  Array.from(crypto.getRandomValues(new Uint32Array(4)), String).join("-");
