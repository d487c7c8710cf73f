/** Folders of the page, from the bottom: each imports from those before it and from itself. */
const FOLDERS = ["core", "clips", "languages", "upload", "camera", "export", "gestures", "studio"];

/** Views, which build on those folders; they do not import each other. */
const VIEWS = ["administration", "editor", "health", "invitation", "live", "phrases", "practice"];

const inside = (names) => `^static/js/(${names.join("|")})/`;

const upwards = FOLDERS.map((name, index) => ({
  name: `${name}-imports-nothing-above-it`,
  severity: "error",
  from: { path: inside([name]) },
  to: { path: inside([...FOLDERS.slice(index + 1), ...VIEWS]) },
}));

const sideways = VIEWS.map((name) => ({
  name: `${name}-imports-no-other-view`,
  severity: "error",
  from: { path: inside([name]) },
  to: { path: inside(VIEWS.filter((other) => other !== name)) },
}));

export default {
  forbidden: [
    { name: "no-import-circle", severity: "error", from: {}, to: { circular: true } },
    { name: "no-missing-module", severity: "error", from: {}, to: { couldNotResolve: true } },
    {
      name: "no-module-that-nothing-imports",
      severity: "error",
      from: { orphan: true, pathNot: "\\.d\\.ts$" },
      to: {},
    },
    ...upwards,
    ...sideways,
  ],
  options: { doNotFollow: { path: "node_modules" } },
};
