// The start of the page: loads the data, registers the views, and binds drawing to the state.

import { drawBatch } from "./clips/batch-card.js";
import { drawClips, findClips } from "./clips/clip-list.js";
import { knowReferences, reloadClips } from "./clips/clip-pages.js";
import { drawQuota, followQuota } from "./clips/quota-line.js";
import { followJob, reloadClip } from "./clips/clip-store.js";
import { bindLibraryWidth } from "./clips/library-width.js";
import { drawSampleClips } from "./clips/sample-clips.js";
import * as api from "./core/api.js";
import { copyLink } from "./core/clipboard.js";
import { byId } from "./core/dom.js";
import { iconOf, render } from "./templates.js";
import { bindKeyList } from "./core/key-dialog.js";
import { listenToKeys } from "./core/key-bindings.js";
import { drawConnection, followServer } from "./core/server-events.js";
import { showSession } from "./core/session.js";
import { follow, followHistory, readUrl, selectedClip, state, update } from "./core/state.js";
import { bindSun } from "./core/sunlight.js";
import { attempt, reserveToasts, toast } from "./core/toasts.js";
import { bindUndo } from "./core/undo.js";
import { followViews, go, loadViews } from "./core/views.js";
import { bindExport, drawExportButton } from "./export/export-dialog.js";
import { bindPicker, drawPicker } from "./languages/language-picker.js";
import { reloadLanguages, reloadOneLanguage } from "./languages/language-store.js";
import { drawTrigger, triggerKey } from "./languages/language-trigger.js";
import { drawTuning } from "./languages/language-tuning.js";
import { followTestSet } from "./languages/test-set.js";
import { showJoint, showMoment } from "./studio/alignment.js";
import { drawGestures } from "./gestures/gesture-cards.js";
import { drawTableButton, openGestureTable } from "./gestures/gesture-table.js";
import { drawRanges } from "./studio/labelled-ranges.js";
import { rememberFrame } from "./studio/playback.js";
import {
  answerQuestion,
  drawOutcome,
  drawStage,
  loadResult,
  loadTakes,
  showSelection,
  stageButtons,
} from "./studio/studio-view.js";
import { drawTakesButton, openTakeTable } from "./export/take-table.js";
import { drawNow } from "./studio/timeline.js";
import { drawTracks } from "./studio/tracks.js";
import { offerTour, startTour } from "./studio/tour.js";
import { drawFlat, drawRatio, drawStroke } from "./studio/clip-picture.js";
import { drawTransport } from "./studio/transport.js";
import { drawVotes } from "./studio/votes.js";
import { drawWelcome, showExample } from "./studio/welcome.js";
import { drawCosts, drawWhy, loadWhy } from "./studio/why.js";
import { followTheme, openWorkspace, restart, recover } from "./studio/workspace.js";
import { forgetArrived } from "./clips/arrived-clips.js";
import { acceptFiles, drawUploads, tellUnsent } from "./upload/upload-list.js";

/** @import { State } from "./core/types.d.ts" */

const VIEWS = [
  { name: "studio", title: "Studio" },
  {
    name: "languages",
    title: "Languages",
    load: () => import("./languages/languages-view.js"),
  },
  {
    name: "gesture",
    title: "Gesture",
    load: () => import("./editor/gesture-editor.js"),
    passing: true,
  },
  { name: "phrases", title: "Phrases", load: () => import("./phrases/phrases-view.js") },
  { name: "health", title: "Health", load: () => import("./health/health-view.js") },
  { name: "practice", title: "Practice", load: () => import("./practice/practice-view.js") },
  { name: "live", title: "Live", load: () => import("./live/live-view.js") },
];

/** Binds each drawing to the values that it depends on. */
function drawEverything() {
  follow(["connected"], drawConnection);
  follow(["uploads"], drawUploads);
  follow(["clips", "jobs", "clip", "library"], drawClips);
  follow(["clips", "jobs", "loaded"], drawBatch);
  follow(["clips", "gestures", "clip", "samples", "loaded"], drawTableButton);
  follow(["clips", "gestures"], drawTakesButton);
  follow(["quota"], drawQuota);
  follow(["quota", "clips", "uploads"], followQuota);
  follow(["samples"], drawSampleClips);
  follow(
    ["samples", "languages", "clips", "uploads", "jobs", "clip", "takes", "loaded", "role"],
    drawWelcome,
  );
  follow(["languages", "language", "loaded"], drawPicker);
  follow(["gestures"], drawExportButton);
  follow(["gestures"], drawTuning);
  follow(["gestures"], drawTrigger);
  follow(["gestures", "languages", "loaded", "result", "clip", "clips"], drawGestures);
  follow(["clips", "clip", "takes", "take", "start", "end", "gestures"], drawStage);
  follow(["clips", "clip", "takes", "take", "start", "end", "gestures", "ranges"], drawRanges);
  follow(["clips", "clip", "timeline", "takes", "take", "start", "end"], drawTracks);
  follow(["position", "clips", "clip"], drawTransport);
  follow(["position"], drawNow);
  follow(["clips", "clip"], drawRatio);
  follow(["position", "clips", "clip", "takes", "take", "start", "end"], drawFlat);
  follow(["result", "clips", "clip", "gestures"], drawVotes);
  follow(["position"], showMoment);
  follow(["joint"], showJoint);
  follow(["result"], drawOutcome);
  follow(["why", "result", "trial", "clips", "clip"], drawWhy);
  follow(["why", "result", "timeline"], drawCosts);
  follow(["why", "result", "clip", "clips"], drawStroke);
}

/** Binds loading to the selection. */
function loadWithSelection() {
  let ready = "";
  follow(["clips", "clip", "gestures", "jobs"], () => {
    const clip = selectedClip();
    const kept = clip && state.jobs.get(clip.job_id)?.kept;
    const now = clip ? `${clip.id} ${triggerKey(state)}` : "";
    const read = clip ? `${now} ${clip.status} ${clip.status === "running" ? kept : ""}` : "";
    if (read === ready) return;
    // Takes of another clip, or by another trigger, must not be shown while these are loading.
    if (!clip || !ready.startsWith(now)) update({ takes: null, timeline: null });
    ready = read;
    loadTakes();
  });
  follow(["recognition"], loadResult);
  follow(["result"], loadWhy);
  follow(["returns"], ({ returns, takes }) => {
    if (!returns) return;
    if (!takes) loadTakes();
    loadResult();
    loadWhy(state);
  });
  follow(["clips", "clip", "takes", "take", "start", "end", "recognition"], showSelection);
  follow(["question", "takes"], answerQuestion);
}

const OF_A_CLIP = new Set([null, "studio", "gesture"]); // Views that show the clip on display.

/**
 * Show which clip or language of a link is missing.
 *
 * @param {Pick<State, "clip" | "language">} linked
 */
function reportMissing({ clip, language }) {
  const gone = [
    clip && !selectedClip() && OF_A_CLIP.has(state.view) ? "clip" : null,
    language && language !== state.language ? "language" : null,
  ]
    .filter(Boolean)
    .join(" and the ");
  if (gone)
    toast(
      `The ${gone} of this link cannot be found`,
      `It was deleted, or is in another studio.${state.clips.length ? " Another one is shown instead." : ""}`,
      { kind: "error" },
    );
}

async function start() {
  render(iconOf("plus"), byId("new-language"));
  const linked = location.search !== "";
  update(readUrl());
  rememberFrame(state.frame);
  const { clip, language } = state;
  followHistory();
  addEventListener("popstate", reloadLanguages);
  followViews(VIEWS);
  listenToKeys();
  render(iconOf("link"), byId("copy-link"));
  render(iconOf("sun"), byId("sun"));
  bindSun();
  bindLibraryWidth();
  byId("copy-link").onclick = copyLink;
  bindKeyList({ loadAll: loadViews, startTour, showExample });
  byId("record-clip").onclick = () => go("live", { source: null });
  byId("make-gestures").onclick = openGestureTable;
  byId("all-takes").onclick = openTakeTable;
  render(iconOf("list"), byId("audit-log"));
  byId("audit-log").onclick = async () => {
    const log = await attempt(
      "Loading the audit log",
      () => import("./administration/audit-log.js"),
    );
    log?.openAuditLog();
  };
  bindUndo();
  reserveToasts();
  showSession();
  acceptFiles();
  findClips();
  bindPicker();
  bindExport();
  stageButtons();
  followTheme();
  drawEverything();
  const [loaded, samples] = await Promise.all([
    reloadClips(),
    attempt("Loading the samples", api.samples.list),
    reloadLanguages(),
    openWorkspace().catch(() => null),
  ]);
  update({ samples: samples ?? [], loaded: true });
  if (linked && loaded) reportMissing({ clip, language });
  if (state.clip && loaded && !selectedClip())
    update({ clip: null, take: null, start: null, end: null, recognition: null });
  const [newest] = state.clips;
  if (!state.clip && newest) update({ clip: newest.id, offered: newest.id });
  follow(["clip", "pending", "gestures", "library"], knowReferences);
  loadWithSelection();
  followTestSet();
  followServer({
    clips: reloadClip,
    languages: reloadOneLanguage,
    jobs: followJob,
    opened: () => {
      reloadClips();
      reloadLanguages();
    },
    returned: restart,
    seen: recover,
  });
  // No tour after a link: its reader came for the linked content.
  if (!linked) offerTour();
  forgetArrived(state.clips);
  tellUnsent();
}

start();
