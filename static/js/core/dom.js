// Creating DOM elements. Text becomes text nodes only: nothing a user wrote is parsed as markup.

/**
 * The strokes of the line icons, in a box of 20 by 20.
 *
 * @type {Record<string, string>}
 */
export const ICONS = {
  back: "M15 4v12L7 10zM5 4v12",
  chevron: "M12 4l-6 6 6 6",
  close: "M5 5l10 10M15 5L5 15",
  down: "M5 8l5 5 5-5",
  forth: "M5 4v12l8-6zM15 4v12",
  link: "M8 12l4-4M9 6l2-2a3.500 3.500 0 0 1 5 5l-2 2M11 14l-2 2a3.500 3.500 0 0 1-5-5l2-2",
  list: "M7 5h9M7 10h9M7 15h9M4 5h.01M4 10h.01M4 15h.01",
  loop: "M6 6h8a3 3 0 0 1 3 3v1M14 14H6a3 3 0 0 1-3-3v-1M12 3.500l2.500 2.500L12 8.500M8 16.500L5.500 14 8 11.500",
  more: "M4 10h.01M10 10h.01M16 10h.01",
  pause: "M7 4v12M13 4v12",
  play: "M6 4v12l10-6z",
  plus: "M10 4v12M4 10h12",
  rename: "M4 16l1-4 8-8 3 3-8 8z",
  retry: "M15.5 6.5A6.5 6.5 0 1 0 16.5 11M16 3v4h-4",
  salute:
    "M7.500 18.500V17L3 13.300c-1-1 .2-2.300 1.300-1.500l2 1.400L3.500 5.600c-.5-1.400 1.200-2 1.700-.7l2.100 5.500M5.300 5.200 4.900 3.700c-.4-1.400 1.400-2 1.900-.6L10.200 11l3-7.900c.5-1.400 2.300-.8 1.900.6l-.4 1.500M12.900 10.400l1.900-5.500c.5-1.300 2.200-.7 1.700.7l-2.700 9c-.2.900-.8 1.600-.8 2.400v1.500",
  sun: "M10 6.500a3.500 3.500 0 1 0 0 7a3.500 3.500 0 0 0 0-7M10 2v1.500M10 16.500V18M2 10h1.500M16.500 10H18M4.300 4.300l1.100 1.100M14.600 14.600l1.100 1.100M4.300 15.700l1.100-1.100M14.600 5.400l1.100-1.100",
  trash: "M4 6h12M8 6V4h4v2M6 6l1 10h6l1-10",
  up: "M5 12l5-5 5 5",
};

/** Marks a control that changes shared data; `session.js` disables it for readers. */
export const WRITES = { "data-writes": "" };

/**
 * Find an element of index.html.
 *
 * @param {string} id
 * @returns {any} Typed loosely: index.html determines the kind of element.
 */
export const byId = (id) => /** @type {any} */ (document.getElementById(id));

/**
 * Disable a button until the work that it began is over.
 *
 * @template T
 * @param {HTMLButtonElement} button
 * @param {() => Promise<T>} work
 * @returns {Promise<T>} What the work returns.
 */
export async function disableDuring(button, work) {
  button.disabled = true;
  return work().finally(() => button.removeAttribute("disabled"));
}

/**
 * Make an element. Properties are set as properties (`onclick`, `className`, `hidden`), those with
 * a dash as attributes; children are elements or text, and null is left out.
 *
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag
 * @param {Record<string, any>} [properties]
 * @param {...any} children
 * @returns {HTMLElementTagNameMap[K]}
 */
export function h(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  const values = /** @type {any} */ (element);
  for (const [name, value] of Object.entries(properties)) {
    if (value === undefined || value === null || name === "src") continue;
    if (name.includes("-") || name === "role" || name === "for") element.setAttribute(name, value);
    else if (name === "style")
      for (const [key, v] of Object.entries(value)) element.style.setProperty(key, v);
    else values[name] = value;
  }
  // Assigning `src` starts loading, in some browsers before `loading: "lazy"` is set.
  const { src } = properties;
  if (src !== undefined && src !== null) values.src = src;
  element.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return element;
}

/**
 * Make an element of a drawing, with attributes.
 *
 * @template {keyof SVGElementTagNameMap} K
 * @param {K} tag
 * @param {Record<string, any>} [attributes]
 * @param {...(string | Node)} children
 * @returns {SVGElementTagNameMap[K]}
 */
export function svg(tag, attributes = {}, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}
