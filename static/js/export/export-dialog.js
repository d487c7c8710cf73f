// The dialog that exports a language: its formats, its contents, and the command to use it.

import * as api from "../core/api.js";
import { copy } from "../core/clipboard.js";
import { byId, h } from "../core/dom.js";
import { bytes, plural, readable } from "../core/format.js";
import { state } from "../core/state.js";
import { attempt, toast } from "../core/toasts.js";
import { go } from "../core/views.js";
import { tuningWords } from "../languages/language-tuning.js";

/** @import { ExportContents, ExportedFile, Language, State, HealthReport } from "../core/types.d.ts" */

/** @type {Record<string, { title: string, text: string, suffix?: string, command: (file: string) => string }>} */
const FORMATS = {
  "osg-studio": {
    title: "OSG Studio language",
    text: "For osg-studio, here or on a robot. Importing it again gives the same language.",
    command: (file) => `osg-studio robot --language ${file} --source 0`,
  },
  "osg-reference": {
    title: "Published OSG format",
    text: "For the published ROS node: images and salient keypoints only. Movement, tuning and commands are left out.",
    command: (file) => `osg-studio convert ${file} language.json`,
  },
  proteus: {
    title: "PROTEUS language definition",
    text: "The gestures as input symbols, for a robot that answers by PROTEUS: names and kinds only.",
    suffix: ".ldf",
    command: (file) => `osg-studio convert language.json ${file}`,
  },
};

/** @param {string[]} names */
const listed = (names) => names.map(readable).join(", ");

/**
 * A name that a shell takes without quotes.
 *
 * @param {string} name
 * @param {{ suffix?: string }} format
 */
const fileName = (name, { suffix = ".json" }) =>
  `${
    name
      .normalize("NFKD")
      .replace(/\p{Mark}/gu, "")
      .replace(/[^\w.-]+/g, "-")
      .replace(/^-+|-+$/g, "") || "language"
  }${suffix}`;

/**
 * @param {ExportedFile} file
 * @param {boolean} chosen
 * @param {(format: ExportedFile["format"]) => void} choose
 */
function choice({ format, bytes: size }, chosen, choose) {
  const { title, text } = FORMATS[format];
  return h(
    "label",
    { className: "export-choice" },
    h("input", {
      type: "radio",
      name: "format",
      value: format,
      checked: chosen,
      onchange: () => choose(format),
    }),
    h("span", {}, h("b", {}, title), h("span", { className: "dim" }, text)),
    h("small", { className: "dim num" }, bytes(size)),
  );
}

/**
 * @param {string} term
 * @param {string} value
 * @param {string} [note]
 */
const row = (term, value, note) =>
  value.length
    ? [h("dt", {}, term), h("dd", {}, value, note ? h("small", { className: "dim" }, note) : null)]
    : [];

/**
 * @param {ExportContents} contents
 * @param {Language} language
 */
function facts(contents, language) {
  const rows = [
    row("Keypoints", listed(contents.salient), "keypoints that must be seen for recognition"),
    row("Better with", listed(contents.limbs)),
    row("Torso", listed(contents.torso), "takes out distance and drift"),
    row(
      "Models",
      contents.models.join(", "),
      "osg-studio models export DIR copies them for a robot without a network",
    ),
    row("Takes", language.trigger_words, "as the robot finds them too"),
    row("Recognised", tuningWords(language), "as kept after a trial; the robot does the same"),
    row("Schema", `${contents.schema_format}, version ${contents.schema_version}`),
    row(
      "Without command",
      contents.without_command.join(", "),
      "the robot receives the label only",
    ),
  ];
  const summary = h("summary", {}, "What the robot needs");
  return h("details", {}, summary, h("dl", { className: "export-facts" }, ...rows));
}

/** @param {() => string} text */
function commandLine(text) {
  const button = h(
    "button",
    { type: "button", onclick: () => copy(text(), "Command copied") },
    "Copy",
  );
  return { button, code: h("code", { id: "export-command" }, text()) };
}

/**
 * @param {Language} language
 * @param {"pdf" | "svg"} format
 */
const slateLink = ({ id, name }, format) =>
  h(
    "a",
    {
      href: api.languages.slate(id, format),
      download: fileName(name, { suffix: `.${format}` }),
    },
    format.toUpperCase(),
  );

/**
 * The printable page for divers, as files.
 *
 * @param {Language} language
 */
const slateLinks = (language) =>
  h(
    "p",
    { className: "export-slate" },
    h("b", {}, "Slate for divers: "),
    "strokes, meanings and the salute on one page, as ",
    slateLink(language, "pdf"),
    " or ",
    slateLink(language, "svg"),
  );

/**
 * What the health check says of the language, as the view Health does.
 *
 * @param {Language} language
 */
function healthLine({ id, revision }) {
  const words = h("span", {}, "Health is being checked\u2026");
  const see = () => {
    byId("dialog").close();
    go("health");
  };
  const link = h("button", { type: "button", className: "link", onclick: see }, "See health");
  const line = h("p", { className: "export-health", role: "status" }, words, " ", link);
  api.languages.check(id, revision).then(
    (/** @type {HealthReport} */ { verdict }) => {
      line.classList.toggle("unwell", !verdict.ready);
      words.textContent = `Health: ${verdict.words}.`;
    },
    () => {
      words.textContent = "Health could not be checked.";
    },
  );
  return line;
}

/** Show the contents of the export. */
export async function openExport() {
  const language = state.gestures;
  if (!language?.gestures.length) {
    toast("Nothing to export", "The language has no gestures yet. Save one from a take first.", {
      kind: "error",
    });
    return;
  }
  const contents = await attempt("Looking at the export", () =>
    api.languages.exportContents(language.id),
  );
  if (!contents) return;
  const dialog = byId("dialog");
  let format = contents.files[0].format;
  const name = () => fileName(contents.name, FORMATS[format]);
  const command = () => FORMATS[format].command(name());
  const { button, code } = commandLine(command);
  const download = h("a", { className: "button primary" }, "Download");
  const show = () => {
    download.download = name();
    download.href = api.languages.exportUrl(language.id, format);
    code.textContent = command();
  };
  /** @param {ExportedFile["format"]} chosen */
  const choose = (chosen) => {
    format = chosen;
    show();
  };
  show();
  download.onclick = () => dialog.close();
  dialog.replaceChildren(
    h(
      "div",
      { className: "export-dialog" },
      h("h2", { id: "dialog-title" }, "Export"),
      h(
        "p",
        { className: "dim" },
        `${contents.name}, revision ${contents.revision}, code ${language.code}, ${plural(language.gestures.length, "gesture")}`,
      ),
      healthLine(language),
      h(
        "div",
        { role: "radiogroup", "aria-label": "Format", className: "export-choices" },
        contents.files.map((file, index) => choice(file, index === 0, choose)),
      ),
      facts(contents, language),
      h("div", { className: "export-command" }, code, button),
      slateLinks(language),
      h(
        "div",
        { className: "dialog-actions" },
        h("button", { type: "button", onclick: () => dialog.close() }, "Close"),
        download,
      ),
    ),
  );
  dialog.setAttribute("aria-labelledby", "dialog-title");
  dialog.onclose = null;
  dialog.showModal();
}

/** Bind the button in the header. */
export function bindExport() {
  byId("export").onclick = openExport;
}

/**
 * Enable the button for a language with gestures.
 *
 * @param {State} state
 */
export function drawExportButton({ gestures }) {
  byId("export").disabled = !gestures?.gestures.length;
}
