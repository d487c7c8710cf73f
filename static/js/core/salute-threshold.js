// The threshold of the salute's score.

/** A score above it opens or closes a take: `ENTER_SCORE` in app/recognition/salute.py. */
export const SALUTE = 0.5;
