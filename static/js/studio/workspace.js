// The viser iframe: one workspace per tab, kept over reloads.

import * as api from "../core/api.js";
import { byId, h } from "../core/dom.js";
import { listenToKeys } from "../core/keys.js";
import { state } from "../core/state.js";
import { complain } from "../core/toasts.js";
import { followClock, frameShown, rememberFrame } from "./playback.js";
import { drawByPage, drawByViser, isFlat } from "./stage-view.js";

const KEY = "osg-studio.workspace"; // sessionStorage: each tab has a workspace of its own.
const LOADING_LIMIT = 20000; // ms. The client is one file of 3 MB from this machine.

const hasWebgl = Boolean(document.createElement("canvas").getContext("webgl2"));
const calm = matchMedia("(prefers-reduced-motion: reduce)");
const prefersDark = matchMedia("(prefers-color-scheme: dark)");
let opened = null; // promise of the workspace's id
let wanted = null; // the view to show
let shown = Promise.resolve();

// A duplicated tab begins with a copy of the first one's sessionStorage. So the workspace's id lies
// there only while no page is there to hold it, and the copy has none.
let mine = sessionStorage.getItem(KEY);
sessionStorage.removeItem(KEY);
addEventListener("pagehide", () => {
  if (mine) sessionStorage.setItem(KEY, mine);
});
addEventListener("pageshow", ({ persisted }) => {
  if (persisted) sessionStorage.removeItem(KEY);
});

/** The workspace of this tab, where the server still knows it. */
const remembered = async () =>
  mine
    ? api.workspaces.find(mine).catch((error) => {
        if (error.status === 404) return null;
        throw error;
      })
    : null;

async function open() {
  let workspace = await remembered();
  if (workspace) await api.workspaces.change(workspace.id, { dark: prefersDark.matches });
  else workspace = await api.workspaces.open(prefersDark.matches);
  mine = workspace.id;
  followClock(mine);
  await api.workspaces.change(workspace.id, { flat: isFlat(), animate: false });
  if (hasWebgl) loadFrame(workspace.url);
  return workspace.id;
}

function loadFrame(url) {
  const frame = byId("lab");
  drawByViser();
  byId("lab-loading").hidden = false;
  const late = setTimeout(
    () =>
      instead("The 3D view has not answered yet; this is the page\u2019s own picture.", restart),
    LOADING_LIMIT,
  );
  frame.onload = () => watch(frame, late);
  frame.src = `${url}?hideViserLogo`;
}

/** The frame loaded something: is it viser, and does it draw? */
function watch(frame, late) {
  const page = frame.contentDocument;
  if (!page?.querySelector("#root")) {
    clearTimeout(late);
    instead("The 3D view did not load; this is the page\u2019s own picture.", restart);
    return;
  }
  const drawn = () => {
    if (!page.querySelector("canvas")) return;
    observer.disconnect();
    clearTimeout(late);
    byId("lab-loading").hidden = true;
    drawByViser();
    listenToKeys(frame.contentWindow); // They mean the same while the 3D view has the focus.
  };
  const observer = new MutationObserver(drawn);
  observer.observe(page.querySelector("#root"), { childList: true, subtree: true });
  drawn();
}

function explain(title, text) {
  const box = byId("lab-problem");
  box.hidden = !title;
  if (!title) return;
  box.replaceChildren(
    h("b", {}, title),
    h("p", {}, text),
    h("button", { type: "button", onclick: restart }, "Try again"),
  );
}

/** Draw the picture by the page, with the reason, and a button that tries viser again. */
function instead(reason, /** @type {(() => unknown) | null} */ retry = null) {
  byId("lab-loading").hidden = true;
  explain(null);
  drawByPage(reason, retry);
}

/** Open the tab's workspace, whose clock the page follows even where viser cannot draw. */
export function openWorkspace() {
  explain(null);
  if (!hasWebgl)
    instead(
      "No space-time cube: this browser offers no WebGL 2. The flat picture is the page\u2019s.",
    );
  opened = open();
  opened.catch(() => explain("The 3D view did not load", "The server did not open a workspace."));
  return opened;
}

/** Load the frame again: viser reconnects by itself only while its frame has the focus. */
export async function restart() {
  rememberFrame(state.frame);
  try {
    await openWorkspace();
    if (wanted) show(wanted).then(frameShown);
  } catch (error) {
    complain(error, "Opening the 3D view");
  }
}

/** Show a view; of several in a row only the newest is sent. */
export function show(view) {
  wanted = view;
  shown = shown.then(() => send(view)).catch((error) => complain(error, "Showing the clip"));
  return shown;
}

async function send(view, again = true) {
  if (view !== wanted) return;
  const id = await opened;
  try {
    await api.workspaces.show(id, view);
  } catch (error) {
    // A restarted server knows no workspaces: open another one, once.
    if (error.status !== 404 || !again || (await remembered())) throw error;
    await openWorkspace();
    await send(view, false);
  }
}

/**
 * Show the picture flat, or the space-time cube.
 *
 * @param {boolean} flat
 */
export async function showFlat(flat) {
  try {
    await api.workspaces.change(await opened, { flat, animate: !calm.matches });
  } catch (error) {
    complain(error, "Changing the view");
  }
}

/** Follow the system between dark and light. */
export function followTheme() {
  prefersDark.addEventListener("change", async () => {
    try {
      await api.workspaces.change(await opened, { dark: prefersDark.matches });
    } catch (error) {
      complain(error, "Changing the colours");
    }
  });
}
