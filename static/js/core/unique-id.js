// Names for what the page has the server do, by which it knows the progress as its own.

/** A name that no other tab gives. Over plain HTTP browsers have no `crypto.randomUUID`. */
export const uniqueId = () =>
  Array.from(crypto.getRandomValues(new Uint32Array(4)), String).join("-");
