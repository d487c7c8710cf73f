import js from "@eslint/js";
import { createNodeResolver, flatConfigs } from "eslint-plugin-import-x";
import globals from "globals";

/** The rooms of the page, from the bottom: a room imports from those before it and from itself. */
const ROOMS = ["core", "clips", "languages", "upload", "export", "studio"];

/** Views that build on the rooms; of each other they know only what is named here. */
const VIEWS = ["editor", "health", "live", "phrases"];

const room = (name) => `./static/js/${name}`;

const upwards = ROOMS.map((name, index) => ({
  target: room(name),
  from: [...ROOMS.slice(index + 1), ...VIEWS].map(room),
  message: `${name} is below that room; see the order in eslint.config.js.`,
}));

const sideways = VIEWS.map((name) => ({
  target: room(name),
  from: VIEWS.filter((other) => other !== name).map(room),
  message: "Views do not import each other; what they share belongs in a room below.",
}));

export default [
  { ignores: ["**/*.d.ts", "test-output/", "build/", ".venv*/"] },
  js.configs.recommended,
  flatConfigs.errors,
  {
    languageOptions: { ecmaVersion: 2024, sourceType: "module" },
    settings: { "import-x/resolver-next": [createNodeResolver()] },
    linterOptions: { reportUnusedDisableDirectives: "error" },
    rules: {
      complexity: ["error", 13],
      eqeqeq: "error",
      "import-x/no-cycle": "error",
      "import-x/no-restricted-paths": ["error", { zones: [...upwards, ...sideways] }],
      "no-var": "error",
      "object-shorthand": "error",
      "prefer-const": "error",
    },
  },
  { files: ["static/**"], languageOptions: { globals: globals.browser } },
  { files: ["tests/page/**", "*.js"], languageOptions: { globals: globals.node } },
];
