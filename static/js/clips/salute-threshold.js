// The threshold of the salute's score.

/** A score above it opens or closes a take: `ENTER_SCORE` in recording/salute.py of the core. */
export const SALUTE = 0.5;
