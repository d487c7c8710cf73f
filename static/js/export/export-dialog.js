// The dialog that exports a language: its formats, its contents, and the command to use it.

import * as api from "../core/api.js";
import { copy } from "../core/clipboard.js";
import { closeDialog, showDialog } from "../core/dialogs.js";
import { byId, h } from "../core/dom.js";
import { bytes, plural, readable } from "../core/format.js";
import { state } from "../core/state.js";
import { attempt, toast } from "../core/toasts.js";
import { go } from "../core/views.js";
import { tuningWords } from "../languages/language-tuning.js";
import { html, nothing, render, until } from "../templates.js";

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
  return html`<label class="export-choice">
    <input
      type="radio"
      name="format"
      value=${format}
      .checked=${chosen}
      @change=${() => choose(format)}
    />
    <span><b>${title}</b><span class="dim">${text}</span></span>
    <small class="dim num">${bytes(size)}</small>
  </label>`;
}

/**
 * @param {string} term
 * @param {string} value
 * @param {string} [note]
 */
const row = (term, value, note = "") =>
  value.length
    ? html`<dt>${term}</dt>
        <dd>${value}${note && html`<small class="dim">${note}</small>`}</dd>`
    : nothing;

/**
 * @param {ExportContents} contents
 * @param {Language} language
 */
const facts = (contents, language) =>
  html`<details>
    <summary>What the robot needs</summary>
    <dl class="export-facts">
      ${row(
        "Keypoints",
        listed(contents.salient),
        "keypoints that must be seen for recognition",
      )}${row("Better with", listed(contents.limbs))}${row(
        "Torso",
        listed(contents.torso),
        "takes out distance and drift",
      )}${row(
        "Models",
        contents.models.join(", "),
        "osg-studio models export DIR copies them for a robot without a network",
      )}${row("Takes", language.trigger_words, "as the robot finds them too")}${row(
        "Recognised",
        tuningWords(language),
        "as kept after a trial; the robot does the same",
      )}${row("Schema", `${contents.schema_format}, version ${contents.schema_version}`)}${row(
        "Without command",
        contents.without_command.join(", "),
        "the robot receives the label only",
      )}
    </dl>
  </details>`;

/**
 * @param {Language} language
 * @param {"pdf" | "svg"} format
 */
const slateLink = ({ id, name }, format) =>
  html`<a
    href=${api.languages.slate(id, format)}
    download=${fileName(name, { suffix: `.${format}` })}
    >${format.toUpperCase()}</a
  >`;

/**
 * The printable page for divers, as files.
 *
 * @param {Language} language
 */
const slateLinks = (language) =>
  html`<p class="export-slate">
    <b>Slate for divers: </b>strokes, meanings and the salute on one page, as
    ${slateLink(language, "pdf")} or ${slateLink(language, "svg")}
  </p>`;

/**
 * What the health check says of the language, as the view Health does.
 *
 * @param {Language} language
 */
function healthLine({ id, revision }) {
  const see = () => {
    closeDialog();
    go("health");
  };
  /** @type {(words: string, bad?: boolean) => unknown} */
  const line = (words, bad = false) =>
    html`<p class="export-health ${bad ? "unwell" : ""}" role="status">
      <span>${words}</span>
      <button type="button" class="link" @click=${see}>See health</button>
    </p>`;
  const checked = api.languages.check(id, revision).then(
    (/** @type {HealthReport} */ { verdict }) => line(`Health: ${verdict.words}.`, !verdict.ready),
    () => line("Health could not be checked."),
  );
  return until(checked, line("Health is being checked\u2026"));
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
  const box = h("div", { className: "export-dialog" });
  const line = healthLine(language);
  const about = `${contents.name}, revision ${contents.revision}, code ${language.code}, ${plural(language.gestures.length, "gesture")}`;
  /** @param {ExportedFile["format"]} format */
  const draw = (format) => {
    const name = fileName(contents.name, FORMATS[format]);
    const command = FORMATS[format].command(name);
    render(
      html`<h2 id="dialog-title">Export</h2>
        <p class="dim">${about}</p>
        ${line}
        <div role="radiogroup" aria-label="Format" class="export-choices">
          ${contents.files.map((file) => choice(file, file.format === format, draw))}
        </div>
        ${facts(contents, language)}
        <div class="export-command">
          <code id="export-command">${command}</code>
          <button type="button" @click=${() => copy(command, "Command copied")}>Copy</button>
        </div>
        ${slateLinks(language)}
        <div class="dialog-actions">
          <button type="button" @click=${closeDialog}>Close</button>
          <a
            class="button primary"
            download=${name}
            href=${api.languages.exportUrl(language.id, format)}
            @click=${closeDialog}
            >Download</a
          >
        </div>`,
      box,
    );
  };
  draw(contents.files[0].format);
  showDialog(box);
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
