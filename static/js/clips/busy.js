// The states of a clip whose poses are still to be found.

/** @import { Clip } from "../core/types.d.ts" */

/** @type {Set<Clip["status"]>} */
export const BUSY = new Set(["queued", "running"]);
