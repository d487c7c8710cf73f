// The ranges of clips that demonstrate a language's gestures.

/** @typedef {{ clip_id: string, start: number, end: number }} Span */

/**
 * The gesture that a range of a clip demonstrates: a recognition of it tests it on itself.
 *
 * @param {{ label: string, demonstrations: { source?: Span | null }[] }[]} gestures
 * @param {{ clip_id: string, start: number | null, end: number | null }} range
 */
export function demonstratedBy(gestures, { clip_id: clip, start, end }) {
  if (start === null || end === null) return null;
  /** @param {Span | null} [source] */
  const shares = (source) =>
    source?.clip_id === clip &&
    2 * (Math.min(end, source.end) - Math.max(start, source.start)) > source.end - source.start;
  const found = gestures.find((each) => each.demonstrations.some(({ source }) => shares(source)));
  return found?.label ?? null;
}

/**
 * The demonstration of a source as the API takes it.
 *
 * @param {Span & { keep_transit: boolean }} source
 */
export const demonstrationOf = ({ clip_id, start, end, keep_transit }) => ({
  clip_id,
  start,
  end,
  keep_transit,
});

/**
 * The clips that demonstrate a language's gestures.
 *
 * @param {{ gestures: { demonstrations: { source?: Span | null }[] }[] } | null} language
 */
export const clipsOfDemonstrations = (language) =>
  (language?.gestures ?? []).flatMap(({ demonstrations }) =>
    demonstrations.flatMap(({ source }) => source?.clip_id ?? []),
  );
