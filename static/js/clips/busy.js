// The states of a clip whose poses are not found yet.

export const BUSY = new Set(["queued", "running"]);
