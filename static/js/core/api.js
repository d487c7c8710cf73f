// The studio's HTTP API. Every failure becomes an ApiError that can be shown as it is.

const BASE = "/api/v1";

export class ApiError extends Error {
  constructor(problem, status) {
    super(problem.detail || problem.title || `The server answered ${status}.`);
    this.name = "ApiError";
    this.title = problem.title || "Something went wrong";
    this.code = problem.code;
    this.status = status;
  }
}

/** What is told when nobody answered. */
export const unreachable = () =>
  new ApiError(
    {
      title: "No connection",
      detail: "The server did not answer. Is it still running? It is tried again by itself.",
      code: "offline",
    },
    0,
  );

/** Whether a call failed only because the server is away for now. */
export const isAway = ({ code }) => code === "offline" || code === "server_stopping";

/** The problem that an answer tells; a proxy's own error page tells none. */
export async function problemOf(response) {
  try {
    return await response.json();
  } catch {
    return { title: response.statusText };
  }
}

async function request(method, path, { body, headers = {}, raw = false } = {}) {
  const options = { method, headers: { ...headers } };
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
  return response.status === 204 ? null : response.json();
}

const id = encodeURIComponent;
const matching = (language) => ({ "If-Match": `"${language.revision}"` });
const gestureAt = (language, label) => `/languages/${id(language.id)}/gestures/${id(label)}`;

export const clips = {
  list: () => request("GET", "/clips"),
  timeline: (clip) => request("GET", `/clips/${id(clip)}/timeline`),
  filmstrip: (clip) => `${BASE}/clips/${id(clip)}/filmstrip`,
  get: (clip) => request("GET", `/clips/${id(clip)}`),
  poses: (clip) => request("GET", `/clips/${id(clip)}/poses`),
  takes: (clip) => request("GET", `/clips/${id(clip)}/takes`),
  remove: (clip) => request("DELETE", `/clips/${id(clip)}`),
  restore: (clip) => request("POST", `/clips/${id(clip)}/restore`),
  retry: (clip) => request("POST", `/clips/${id(clip)}/jobs`),
  chooseTopic: (clip, topic) => request("POST", `/clips/${id(clip)}/topic`, { body: { topic } }),
  poster: (clip) => `${BASE}/clips/${id(clip)}/poster`,
  session: (clip) => `${BASE}/clips/${id(clip)}/session.mcap`,
  video: (clip) => `${BASE}/clips/${id(clip)}/video`,
};

export const jobs = {
  get: (job) => request("GET", `/jobs/${id(job)}`),
  cancel: (job) => request("DELETE", `/jobs/${id(job)}`),
};

export const samples = {
  list: () => request("GET", "/samples"),
  add: (name) => request("POST", "/samples", { body: { name } }),
  languages: () => request("GET", "/samples/languages"),
  addLanguage: (name) => request("POST", "/samples/languages", { body: { name } }),
};

export const languages = {
  list: () => request("GET", "/languages"),
  get: (language) => request("GET", `/languages/${id(language)}`),
  create: (name) => request("POST", "/languages", { body: { name } }),
  change: (language, change) =>
    request("PATCH", `/languages/${id(language.id)}`, {
      body: change,
      headers: matching(language),
    }),
  duplicate: (language) => request("POST", `/languages/${id(language)}/duplicate`),
  revisions: (language) => request("GET", `/languages/${id(language)}/revisions`),
  compare: (language, older, newer) =>
    request(
      "GET",
      `/languages/${id(language)}/comparison?newer=${newer}${older === null ? "" : `&older=${older}`}`,
    ),
  phrases: ({ id: language, revision }, gestures, paused) =>
    request(
      "GET",
      `/languages/${id(language)}/phrases?${new URLSearchParams([["revision", revision], ["then", paused ? "pause" : "wait"], ...gestures.map((label) => ["gesture", label])])}`,
    ),
  check: (language, revision) =>
    request("GET", `/languages/${id(language)}/check?revision=${revision}`),
  cancelCheck: (language, revision) =>
    request("DELETE", `/languages/${id(language)}/check?revision=${revision}`),
  contrast: (language, one, other, revision) =>
    request(
      "GET",
      `/languages/${id(language)}/contrast?one=${id(one)}&other=${id(other)}&revision=${revision}`,
    ),
  image: (language, label, revision) =>
    `${BASE}${gestureAt({ id: language }, label)}/image?revision=${revision}`,
  restore: (language) => request("POST", `/languages/${id(language)}/restore`),
  remove: (language) =>
    request(
      "DELETE",
      `/languages/${id(language.id)}`,
      "revision" in language ? { headers: matching(language) } : {},
    ),
  import: (name, text) =>
    request("POST", `/languages/import?name=${id(name)}`, { body: text, raw: true }),
  revert: (language, revision) =>
    request("POST", `/languages/${id(language.id)}/revert`, {
      body: { revision },
      headers: matching(language),
    }),
  preview: (language, body) => request("POST", `/languages/${id(language)}/preview`, { body }),
  previewHealth: (language, body) =>
    request("POST", `/languages/${id(language)}/preview/health`, { body }),
  demonstration: (language, label) =>
    request("GET", `${gestureAt({ id: language }, label)}/demonstration`),
  addGesture: (language, gesture) =>
    request("POST", `/languages/${id(language.id)}/gestures`, {
      body: gesture,
      headers: matching(language),
    }),
  changeGesture: (language, label, change) =>
    request("PATCH", gestureAt(language, label), { body: change, headers: matching(language) }),
  removeGesture: (language, label) =>
    request("DELETE", gestureAt(language, label), { headers: matching(language) }),
  exportContents: (language) => request("GET", `/languages/${id(language)}/export/contents`),
  exportUrl: (language, format) => `${BASE}/languages/${id(language)}/export?format=${format}`,
};

export const recognitions = {
  create: (query) => request("POST", "/recognitions", { body: query }),
  list: (language) => request("GET", `/recognitions?language_id=${id(language)}&limit=500`),
  get: (recognition) => request("GET", `/recognitions/${id(recognition)}`),
  analysisUrl: (recognition) => `${BASE}/recognitions/${id(recognition)}/analysis`,
  explain: (recognition) => request("GET", `/recognitions/${id(recognition)}/explanation`),
};

export const workspaces = {
  open: (dark) => request("POST", "/workspaces", { body: { dark } }),
  find: (workspace) => request("GET", `/workspaces/${id(workspace)}`),
  change: (workspace, dark) => request("PATCH", `/workspaces/${id(workspace)}`, { body: { dark } }),
  show: (workspace, view) => request("PUT", `/workspaces/${id(workspace)}/view`, { body: view }),
};

/** Follow everything that changes on the server. */
export const changes = () => new EventSource(`${BASE}/events`);
