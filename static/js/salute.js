// What counts as a Vulcan salute.

/** A score above it opens or closes a take: `ENTER_SCORE` in app/recognition/recording/salute.py. */
export const SALUTE = 0.5;
