// The studio's HTTP API. Every failure becomes an ApiError that can be shown as it is.

/** @import { AuditEntry, Choice, Clip, ClipAccepted, ClipPage, Explanation, ExportContents, HealthReport, Invitation, Job, Language, LanguageSettings, LanguageSummary, NewInvitation, Outlook, PairDifference, PhrasesAnswer, Poses, PracticeAnswer, PracticeRecord, Preview, Problem, ReceivedTake, ReceivedTakeOutlook, Recognition, Replacement, Revision, RevisionDiff, Sample, SampleLanguage, Session, Take, TakeTable, TestSet, Timeline, TriggerDraft, Workspace, WrittenSession } from "./types.d.ts" */

// Relative to the page, which a reverse proxy may serve under a path of its own.
export const BASE = "api/v1";

const CLIPS_OF_A_PAGE = 500; // Half a megabyte; takes the server 50 ms.

export class ApiError extends Error {
  /**
   * @param {Problem} problem
   * @param {number} status
   */
  constructor(problem, status) {
    super(problem.detail || problem.title || `The server answered ${status}.`);
    this.name = "ApiError";
    this.title = problem.title || "Something went wrong";
    this.code = problem.code;
    this.errors = problem.errors ?? [];
    this.status = status;
  }
}

/** The error of a request that got no answer. */
export const unreachable = () =>
  new ApiError(
    {
      title: "No connection",
      detail: "The server did not answer. Is it still running? The page reconnects by itself.",
      code: "offline",
    },
    0,
  );

/**
 * Whether a request failed only because the server is away for now.
 *
 * @param {{ code?: string }} error
 */
export const isAway = ({ code }) => code === "offline" || code === "server_stopping";

/**
 * Read the problem JSON of a response; a proxy's own error page has none.
 *
 * @param {Response} response
 * @returns {Promise<Problem>}
 */
export async function problemOf(response) {
  try {
    return await response.json();
  } catch {
    return { title: response.statusText };
  }
}

/**
 * @param {string} method
 * @param {string} path
 * @param {{ body?: any, headers?: Record<string, string>, raw?: boolean, signal?: AbortSignal }} [options]
 * @returns {Promise<any>}
 */
async function request(method, path, options) {
  const response = await send(method, path, options);
  return response.status === 204 ? null : response.json();
}

/**
 * @param {string} method
 * @param {string} path
 * @param {{ body?: any, headers?: Record<string, string>, raw?: boolean, signal?: AbortSignal }} [options]
 */
async function send(method, path, { body, headers = {}, raw = false, signal } = {}) {
  /** @type {RequestInit & { headers: Record<string, string> }} */
  const options = { method, headers: { ...headers }, signal };
  // Chromium's cache delays a change, by up to 20 s, until a read of the same address has ended;
  // without this option a running check could not be cancelled.
  if (method !== "GET") options.cache = "no-store";
  if (body !== undefined) {
    options.body = raw ? body : JSON.stringify(body);
    options.headers["Content-Type"] = "application/json";
  }
  let response;
  try {
    response = await fetch(BASE + path, options);
  } catch {
    throw unreachable();
  }
  if (!response.ok) throw new ApiError(await problemOf(response), response.status);
  return response;
}

/**
 * The address of a path that the server named, as seen from the page.
 *
 * @param {string} path
 */
export const beside = (path) => path.replace(/^\//, "");

/**
 * Open a WebSocket of the API.
 *
 * @param {string} path
 * @param {string[]} [protocols]
 */
export function openSocket(path, protocols = []) {
  const address = new URL(BASE + path, document.baseURI);
  address.protocol = address.protocol.replace("http", "ws");
  return new WebSocket(address, protocols);
}

const id = encodeURIComponent;
/** @param {{ revision?: number }} language */
const matching = (language) => ({ "If-Match": `"${language.revision}"` });
/**
 * The address of a gesture, or of a part of it. Its label is in the query, because a browser
 * resolves the path "/gestures/..".
 *
 * @param {{ id: string }} language
 * @param {string} label
 * @param {"" | "/image" | "/demonstration"} [part]
 */
const gestureAt = (language, label, part = "") =>
  `/languages/${id(language.id)}/gestures${part}?label=${id(label)}`;

/** @param {string | null} language whose trigger is used; null: the salute */
const triggered = (language, soFar = false) => {
  const query = new URLSearchParams(soFar ? { so_far: "true" } : {});
  if (language) query.set("language_id", language);
  return query.size ? `?${query}` : "";
};

export const session = {
  /** @type {() => Promise<Session>} */
  get: () => request("GET", "/session"),
  end: () => request("DELETE", "/session"),
};

export const audit = {
  /** @type {(query: Record<string, string>) => Promise<AuditEntry[]>} */
  list: (query) => request("GET", `/audit?${new URLSearchParams(query)}`),
};

/**
 * The address of a clip's pictures, another one once they are turned: browsers keep them.
 *
 * @param {Pick<Clip, "id"> & Partial<Clip>} clip
 * @param {"video" | "poster" | "filmstrip"} which
 */
const picture = (clip, which) =>
  `${BASE}/clips/${id(clip.id)}/${which}${clip.turn ? `?turned=${clip.turn}` : ""}`;

export const clips = {
  /**
   * A page of the clips, newest first: those after a clip, those whose name contains `q`, those in
   * a state, or those of some ids.
   *
   * @param {{ after?: string, q?: string, status?: string[], id?: string[] }} [which]
   * @returns {Promise<ClipPage>}
   */
  page: async (which = {}) => {
    const query = new URLSearchParams({ limit: String(CLIPS_OF_A_PAGE) });
    for (const [name, value] of Object.entries(which))
      for (const each of [value].flat()) query.append(name, each);
    const response = await send("GET", `/clips?${query}`);
    return {
      clips: await response.json(),
      more: response.headers.has("Link"),
      total: Number(response.headers.get("X-Total-Count")),
    };
  },
  /** @type {(clip: string, by?: string | null, soFar?: boolean) => Promise<Timeline>} */
  timeline: (clip, by = null, soFar = false) =>
    request("GET", `/clips/${id(clip)}/timeline${triggered(by, soFar)}`),
  /** @type {(clip: Clip) => string} */
  filmstrip: (clip) => picture(clip, "filmstrip"),
  /** @type {(clip: string) => Promise<Clip>} */
  get: (clip) => request("GET", `/clips/${id(clip)}`),
  /** @type {(clip: string) => Promise<Poses>} */
  poses: (clip) => request("GET", `/clips/${id(clip)}/poses`),
  /** @type {(clip: string, by?: string | null, soFar?: boolean) => Promise<Take[]>} */
  takes: (clip, by = null, soFar = false) =>
    request("GET", `/clips/${id(clip)}/takes${triggered(by, soFar)}`),
  /** @type {(clip: string) => Promise<unknown>} */
  remove: (clip) => request("DELETE", `/clips/${id(clip)}`),
  /** @type {(clip: string) => Promise<Clip>} */
  restore: (clip) => request("POST", `/clips/${id(clip)}/restore`),
  /** @type {(clip: string) => Promise<unknown>} */
  retry: (clip) => request("POST", `/clips/${id(clip)}/jobs`),
  /** @type {(clip: string, topic: string) => Promise<unknown>} */
  chooseTopic: (clip, topic) => request("POST", `/clips/${id(clip)}/topic`, { body: { topic } }),
  /** @type {(clip: string, degrees: 90 | 180 | 270) => Promise<ClipAccepted>} */
  turn: (clip, degrees) => request("POST", `/clips/${id(clip)}/turn`, { body: { degrees } }),
  /** @type {(clip: Clip) => string} */
  poster: (clip) => picture(clip, "poster"),
  /**
   * Write a session on the server; its progress comes as events of that `name`.
   *
   * @type {(clip: string, name: string, signal: AbortSignal) => Promise<WrittenSession>}
   */
  writeSession: (clip, name, signal) =>
    request("POST", `/clips/${id(clip)}/session.mcap`, { body: { id: name }, signal }),
  /**
   * The address from which the browser saves a session that was written.
   *
   * @type {(clip: string, name: string) => string}
   */
  session: (clip, name) => `${BASE}/clips/${id(clip)}/session.mcap?export=${id(name)}`,
  /** @type {(clip: Pick<Clip, "id"> & Partial<Clip>) => string} */
  video: (clip) => picture(clip, "video"),
};

export const jobs = {
  /** @type {(job: string) => Promise<Job>} */
  get: (job) => request("GET", `/jobs/${id(job)}`),
  /** @type {(job: string) => Promise<unknown>} */
  cancel: (job) => request("DELETE", `/jobs/${id(job)}`),
};

export const samples = {
  /** @type {() => Promise<Sample[]>} */
  list: () => request("GET", "/samples"),
  /** @type {(name: string) => Promise<ClipAccepted>} */
  add: (name) => request("POST", "/samples", { body: { name } }),
  /** @type {() => Promise<SampleLanguage[]>} */
  languages: () => request("GET", "/samples/languages"),
  /** @type {(name: string) => Promise<Language>} */
  addLanguage: (name) => request("POST", "/samples/languages", { body: { name } }),
};

export const languages = {
  /** @type {() => Promise<LanguageSummary[]>} */
  list: () => request("GET", "/languages"),
  /** @type {(language: string) => Promise<Language>} */
  get: (language) => request("GET", `/languages/${id(language)}`),
  /** @type {(name: string) => Promise<Language>} */
  create: (name) => request("POST", "/languages", { body: { name } }),
  /** @type {(language: { id: string, revision: number }, change: object) => Promise<Language>} */
  change: (language, change) =>
    request("PATCH", `/languages/${id(language.id)}`, {
      body: change,
      headers: matching(language),
    }),
  /** @type {(language: { id: string, revision: number }, trigger: TriggerDraft) => Promise<Language>} */
  setTrigger: (language, trigger) =>
    request("PUT", `/languages/${id(language.id)}/trigger`, {
      body: trigger,
      headers: matching(language),
    }),
  /** @type {(language: string) => Promise<Language>} */
  duplicate: (language) => request("POST", `/languages/${id(language)}/duplicate`),
  /** @type {(language: string) => Promise<Revision[]>} */
  revisions: (language) => request("GET", `/languages/${id(language)}/revisions`),
  /** @type {(language: string, older: number | null, newer: number) => Promise<RevisionDiff>} */
  compare: (language, older, newer) =>
    request(
      "GET",
      `/languages/${id(language)}/comparison?newer=${newer}${older === null ? "" : `&older=${older}`}`,
    ),
  /** @type {(language: { id: string, revision: number }, gestures: string[], paused: boolean) => Promise<PhrasesAnswer>} */
  phrases: ({ id: language, revision }, gestures, paused) => {
    const query = new URLSearchParams({
      revision: String(revision),
      then: paused ? "pause" : "wait",
    });
    for (const label of gestures) query.append("gesture", label);
    return request("GET", `/languages/${id(language)}/phrases?${query}`);
  },
  /** @type {(language: string, revision: number) => Promise<HealthReport>} */
  check: (language, revision) =>
    request("GET", `/languages/${id(language)}/check?revision=${revision}`),
  /** @type {(language: string, revision: number) => Promise<unknown>} */
  cancelCheck: (language, revision) =>
    request("DELETE", `/languages/${id(language)}/check?revision=${revision}`),
  /** @type {(language: string, one: string, other: string, revision: number) => Promise<PairDifference>} */
  contrast: (language, one, other, revision) =>
    request(
      "GET",
      `/languages/${id(language)}/contrast?one=${id(one)}&other=${id(other)}&revision=${revision}`,
    ),
  /** @type {(takes: { keep: number, language_id: string | null, gestures: object[] }, signal: AbortSignal) => Promise<Choice>} */
  choose: (takes, signal) => request("POST", "/languages/choice", { body: takes, signal }),
  /** @type {(language: { id: string, revision: number }, wanted: { label: string, gestures: object[] }, signal: AbortSignal) => Promise<{ people: string | null, replacements: Replacement[] }>} */
  replacements: (language, wanted, signal) =>
    request("POST", `/languages/${id(language.id)}/replacements?revision=${language.revision}`, {
      body: wanted,
      signal,
    }),
  /** @type {(language: { id: string, revision: number }, movement: object) => Promise<Language>} */
  replaceGesture: (language, movement) =>
    request("PUT", `/languages/${id(language.id)}/replacements`, {
      body: movement,
      headers: matching(language),
    }),
  /** @type {(language: string, label: string, revision: number) => string} */
  image: (language, label, revision) =>
    `${BASE}${gestureAt({ id: language }, label, "/image")}&revision=${revision}&marks=true`,
  /** @type {(language: string) => Promise<Language>} */
  restore: (language) => request("POST", `/languages/${id(language)}/restore`),
  /** @type {(language: { id: string, revision?: number }) => Promise<unknown>} */
  remove: (language) =>
    request(
      "DELETE",
      `/languages/${id(language.id)}`,
      "revision" in language ? { headers: matching(language) } : {},
    ),
  /** @type {(name: string, text: string) => Promise<Language>} */
  import: (name, text) =>
    request("POST", `/languages/import?name=${id(name)}`, { body: text, raw: true }),
  /** @type {(language: { id: string, revision: number }, revision: number) => Promise<Language>} */
  revert: (language, revision) =>
    request("POST", `/languages/${id(language.id)}/revert`, {
      body: { revision },
      headers: matching(language),
    }),
  /** @type {(language: string, body: object) => Promise<Preview>} */
  preview: (language, body) =>
    request("POST", `/languages/${id(language)}/preview?marks=true`, { body }),
  /** @type {(language: string, body: object) => Promise<Outlook>} */
  previewHealth: (language, body) =>
    request("POST", `/languages/${id(language)}/preview/health`, { body }),
  /** @type {(language: string, label: string) => Promise<Poses>} */
  demonstration: (language, label) =>
    request("GET", gestureAt({ id: language }, label, "/demonstration")),
  /** @type {(language: { id: string, revision: number }, gesture: object) => Promise<Language>} */
  addGesture: (language, gesture) =>
    request("POST", `/languages/${id(language.id)}/gestures`, {
      body: gesture,
      headers: matching(language),
    }),
  /** @type {(language: { id: string, revision: number }, gestures: object[]) => Promise<Language>} */
  addGestures: (language, gestures) =>
    request("POST", `/languages/${id(language.id)}/gestures/batch`, {
      body: { gestures },
      headers: matching(language),
    }),
  /** @type {(language: { id: string, revision: number }, label: string, change: object) => Promise<Language>} */
  changeGesture: (language, label, change) =>
    request("PATCH", gestureAt(language, label), { body: change, headers: matching(language) }),
  /** @type {(language: { id: string, revision: number }, label: string) => Promise<Language>} */
  removeGesture: (language, label) =>
    request("DELETE", gestureAt(language, label), { headers: matching(language) }),
  /** @type {(language: { id: string, revision: number }, demonstration: object) => Promise<Language>} */
  addDemonstration: (language, demonstration) =>
    request("POST", `/languages/${id(language.id)}/demonstrations`, {
      body: demonstration,
      headers: matching(language),
    }),
  /** @type {(language: { id: string, revision: number }, label: string, index: number) => Promise<Language>} */
  removeDemonstration: (language, label, index) =>
    request("DELETE", `/languages/${id(language.id)}/demonstrations/${index}?label=${id(label)}`, {
      headers: matching(language),
    }),
  /** @type {(language: string, table: string, clips: string[], signal: AbortSignal) => Promise<TakeTable>} */
  takeTable: (language, table, clips, signal) =>
    request("POST", `/languages/${id(language)}/take-table`, {
      body: { id: table, clip_ids: clips },
      signal,
    }),
  /** @type {(language: string) => Promise<ExportContents>} */
  exportContents: (language) => request("GET", `/languages/${id(language)}/export/contents`),
  /** @type {(language: string) => Promise<LanguageSettings>} */
  settings: (language) => request("GET", `/languages/${id(language)}/settings`),
  /** @type {(language: string, format: "pdf" | "svg") => string} */
  slate: (language, format) => `${BASE}/languages/${id(language)}/slate.${format}`,
  /** @type {(language: string, format: string) => string} */
  exportUrl: (language, format) => `${BASE}/languages/${id(language)}/export?format=${format}`,
};

export const testSets = {
  /** @type {(language: string) => Promise<TestSet>} */
  get: (language) => request("GET", `/languages/${id(language)}/test-set`),
  /** @type {(language: string, takes: object[]) => Promise<TestSet>} */
  add: (language, takes) =>
    request("POST", `/languages/${id(language)}/test-set`, { body: { takes } }),
  /** @type {(language: string, take: string, expected: string) => Promise<TestSet>} */
  label: (language, take, expected) =>
    request("PATCH", `/languages/${id(language)}/test-set/${id(take)}`, { body: { expected } }),
  /** @type {(language: string, take: string) => Promise<TestSet>} */
  remove: (language, take) => request("DELETE", `/languages/${id(language)}/test-set/${id(take)}`),
  /** @type {(language: string) => Promise<TestSet>} */
  run: (language) => request("POST", `/languages/${id(language)}/test-set/run`),
  /** @type {(language: string) => Promise<unknown>} */
  cancel: (language) => request("DELETE", `/languages/${id(language)}/test-set/run`),
};

/** @type {(language: string, invitation: string, take: string) => string} */
const takeAt = (language, invitation, take) =>
  `/languages/${id(language)}/invitations/${id(invitation)}/takes/${id(take)}`;

export const invitations = {
  /** @type {(language: string) => Promise<Invitation[]>} */
  list: (language) => request("GET", `/languages/${id(language)}/invitations`),
  /** @type {(language: string, limits: { people: number, days: number }) => Promise<NewInvitation>} */
  make: (language, limits) =>
    request("POST", `/languages/${id(language)}/invitations`, { body: limits }),
  /** @type {(language: string, invitation: string) => Promise<null>} */
  withdraw: (language, invitation) =>
    request("DELETE", `/languages/${id(language)}/invitations/${id(invitation)}`),
  /** @type {(language: string, invitation: string, take: string) => Promise<ReceivedTakeOutlook>} */
  outlook: (language, invitation, take) => request("GET", takeAt(language, invitation, take)),
  /** @type {(language: string, invitation: string, take: string, status: "added" | "removed") => Promise<ReceivedTake>} */
  settle: (language, invitation, take, status) =>
    request("PUT", takeAt(language, invitation, take), { body: { status } }),
};

export const practice = {
  /** @type {(language: string) => Promise<PracticeRecord[]>} */
  records: (language) => request("GET", `/languages/${id(language)}/practice`),
  /** @type {(language: string, take: object) => Promise<PracticeAnswer>} */
  show: (language, take) => request("POST", `/languages/${id(language)}/practice`, { body: take }),
  /** @type {(language: string, take: string) => Promise<PracticeRecord[]>} */
  remove: (language, take) => request("DELETE", `/languages/${id(language)}/practice/${id(take)}`),
};

export const recognitions = {
  /** @type {(query: object) => Promise<Recognition>} */
  create: (query) => request("POST", "/recognitions", { body: query }),
  /** @type {(recognition: string) => Promise<Recognition>} */
  get: (recognition) => request("GET", `/recognitions/${id(recognition)}`),
  /** @type {(recognition: string) => string} */
  analysisUrl: (recognition) => `${BASE}/recognitions/${id(recognition)}/analysis`,
  /** @type {(recognition: string) => Promise<{ caption: string, image: string }[]>} */
  images: (recognition) => request("GET", `/recognitions/${id(recognition)}/images`),
  /** @type {(recognition: string, expected: string) => Promise<Explanation>} */
  explain: (recognition, expected) =>
    request("GET", `/recognitions/${id(recognition)}/explanation?expected=${id(expected)}`),
};

export const workspaces = {
  /** @type {(dark: boolean) => Promise<Workspace>} */
  open: (dark) => request("POST", "/workspaces", { body: { dark } }),
  /** @type {(workspace: string) => Promise<Workspace>} */
  find: (workspace) => request("GET", `/workspaces/${id(workspace)}`),
  /** @type {(workspace: string, look: { dark?: boolean, flat?: boolean, animate?: boolean }) => Promise<unknown>} */
  change: (workspace, look) => request("PATCH", `/workspaces/${id(workspace)}`, { body: look }),
  /** @type {(workspace: string, view: object) => Promise<unknown>} */
  show: (workspace, view) => request("PUT", `/workspaces/${id(workspace)}/view`, { body: view }),
};

/** Follow everything that changes on the server. */
export const changes = () => new EventSource(`${BASE}/events`);
