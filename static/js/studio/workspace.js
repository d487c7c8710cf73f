// The viser iframe: one workspace per tab, kept over reloads.

import { tellTrouble } from "../camera/camera.js";
import * as api from "../core/api.js";
import { tabStore } from "../core/browser-store.js";
import { byId } from "../core/dom.js";
import { listenToKeys } from "../core/key-bindings.js";
import { state } from "../core/state.js";
import { attempt, complain } from "../core/toasts.js";
import { nothing, render } from "../templates.js";
import { followClock, frameShown, rememberFrame, wasCut } from "./playback.js";
import { drawByPage, drawByViser, isFlat } from "./clip-picture.js";

/** @import { Trouble } from "../camera/live-messages.d.ts" */
/** @import { WorkspaceView } from "../core/types.d.ts" */

const KEY = "osg-studio.workspace"; // Each tab has a workspace of its own.
const LOADING_LIMIT = 20000; // ms. The client is one file of 3 MB from this machine.

const hasWebgl = Boolean(document.createElement("canvas").getContext("webgl2"));
const calm = matchMedia("(prefers-reduced-motion: reduce)");
const prefersDark = matchMedia("(prefers-color-scheme: dark)");
/** @type {Promise<string> | null} */
let opened = null; // promise of the workspace's id
/** @type {WorkspaceView | null} */
let wanted = null; // the view to show
let shown = Promise.resolve();

// A duplicated tab begins with a copy of what the first one keeps. So the workspace's id is
// stored there only while no page is open to hold it, and the copy has none.
let mine = tabStore.get(KEY);
tabStore.set(KEY, null);
addEventListener("pagehide", () => {
  if (mine) tabStore.set(KEY, mine);
});
addEventListener("pageshow", ({ persisted }) => {
  if (persisted) tabStore.set(KEY, null);
});

/** The workspace of this tab, if it still exists on the server. */
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

/** @param {string} url */
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
  frame.src = `${api.beside(url)}?hideViserLogo`;
  Object.assign(byId("lab-tab"), { href: api.beside(url), hidden: false });
}

/**
 * Called when the frame has loaded: check that it is viser and that it draws.
 *
 * @param {HTMLIFrameElement} frame
 * @param {number} late
 */
function watch(frame, late) {
  const page = frame.contentDocument;
  const inner = frame.contentWindow;
  const root = page?.querySelector("#root");
  if (!root || !inner) {
    clearTimeout(late);
    instead("The 3D view did not load; this is the page\u2019s own picture.", restart);
    return;
  }
  // viser's panel is for its own tab: here the page shows what is in it.
  page?.documentElement.toggleAttribute("data-embedded", true);
  const drawn = () => {
    if (!root.querySelector("canvas")) return;
    observer.disconnect();
    clearTimeout(late);
    byId("lab-loading").hidden = true;
    drawByViser();
    listenToKeys(inner); // They mean the same while the 3D view has the focus.
  };
  const observer = new MutationObserver(drawn);
  observer.observe(root, { childList: true, subtree: true });
  drawn();
}

/** @param {Trouble | null} trouble */
function explain(trouble) {
  const box = byId("lab-problem");
  box.hidden = !trouble;
  render(trouble ? tellTrouble(trouble, restart) : nothing, box);
}

/**
 * Draw the picture by the page, with the reason, and a button that tries viser again.
 *
 * @param {string} reason
 * @param {(() => unknown) | null} [retry]
 */
function instead(reason, retry = null) {
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
  opened.catch(() =>
    explain({ title: "The 3D view did not load", text: "The server did not open a workspace." }),
  );
  return opened;
}

/** The id of the workspace of this tab. */
const workspaceOf = () => opened ?? openWorkspace();

/** Load the frame again: viser reconnects by itself only while its frame has the focus. */
export async function restart() {
  rememberFrame(state.frame);
  const id = await attempt("Opening the 3D view", openWorkspace);
  if (id && wanted) show(wanted).then(frameShown);
}

/**
 * Open the 3D view again if it is lost: a page in the background does not notice when the server
 * closes its workspace or the network fails.
 */
export async function recover() {
  if (!opened) return;
  const isLost = async () => wasCut() || !(await remembered());
  if (await attempt("Opening the 3D view", isLost)) await restart();
}

/**
 * Show a view; of several in a row only the newest is sent.
 *
 * @param {WorkspaceView} view
 */
export function show(view) {
  wanted = view;
  shown = shown.then(() => send(view)).catch((error) => complain(error, "Showing the clip"));
  return shown;
}

/**
 * @param {WorkspaceView} view
 * @param {boolean} [again]
 */
async function send(view, again = true) {
  if (view !== wanted) return;
  const id = await workspaceOf();
  try {
    await api.workspaces.show(id, view);
  } catch (error) {
    // A restarted server has no workspaces: open another one, once.
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
export const showFlat = (flat) =>
  attempt("Changing the view", async () =>
    api.workspaces.change(await workspaceOf(), { flat, animate: !calm.matches }),
  );

/** Follow the system between dark and light. */
export function followTheme() {
  prefersDark.addEventListener("change", () =>
    attempt("Changing the colours", async () =>
      api.workspaces.change(await workspaceOf(), { dark: prefersDark.matches }),
    ),
  );
}
