// The server: its addresses, and what it answers when it fails, which can be shown as it is.

/** @import { Problem } from "./types.d.ts" */

// Relative to the page, which a reverse proxy may serve under a path of its own.
export const BASE = "api/v1";

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
