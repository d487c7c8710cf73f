// The states of a clip whose poses are still to be found.

export const BUSY = new Set(["queued", "running"]);
