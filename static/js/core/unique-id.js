// Names for tasks that the page starts on the server, so that it recognises their progress events.

/** A unique name across tabs. Over plain HTTP browsers have no `crypto.randomUUID`. */
export const uniqueId = () =>
  Array.from(crypto.getRandomValues(new Uint32Array(4)), String).join("-");
