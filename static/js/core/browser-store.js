// What the browser keeps for the page: for all visits, or for the tab. Where it keeps nothing (site
// data are refused, absent or full), the page keeps it itself, for the visit.

/** @param {"localStorage" | "sessionStorage"} name */
function storeOf(name) {
  /** @type {Map<string, string | null>} */
  const unkept = new Map();
  return {
    /**
     * The text under a key; null where there is none.
     *
     * @param {string} key
     * @returns {string | null}
     */
    get(key) {
      try {
        return unkept.has(key) ? (unkept.get(key) ?? null) : globalThis[name].getItem(key);
      } catch {
        return null;
      }
    },

    /**
     * Keep a text under a key; null removes it.
     *
     * @param {string} key
     * @param {string | null} text
     */
    set(key, text) {
      try {
        if (text === null) globalThis[name].removeItem(key);
        else globalThis[name].setItem(key, text);
        unkept.delete(key);
      } catch {
        unkept.set(key, text);
      }
    },

    /**
     * The value that was kept as JSON; null where there is none, or where it is damaged.
     *
     * @param {string} key
     * @returns {any}
     */
    read(key) {
      try {
        return JSON.parse(this.get(key) ?? "null");
      } catch {
        return null;
      }
    },

    /**
     * Keep a value as JSON.
     *
     * @param {string} key
     * @param {unknown} value
     */
    write(key, value) {
      this.set(key, JSON.stringify(value));
    },
  };
}

/** Kept for all visits. */
export const browserStore = storeOf("localStorage");

/** Kept while the tab is open, over reloads. */
export const tabStore = storeOf("sessionStorage");
