import js from "@eslint/js";
import globals from "globals";

export default [
  {
    ignores: [
      "htmlcov/",
      "**/*.d.ts",
      "static/vendor/",
      "test-output/",
      "build/",
      "dist/",
      ".venv*/",
    ],
  },
  js.configs.recommended,
  {
    languageOptions: { ecmaVersion: 2024, sourceType: "module" },
    linterOptions: { reportUnusedDisableDirectives: "error" },
    rules: {
      complexity: ["error", 13],
      eqeqeq: "error",
      "max-len": [
        "error",
        {
          code: 100,
          ignorePattern: "@(import|param|type|typedef|returns) ",
          ignoreStrings: true,
          ignoreTemplateLiterals: true,
        },
      ],
      "no-restricted-syntax": [
        "error",
        {
          selector:
            ":not(TaggedTemplateExpression) > TemplateLiteral > TemplateElement[value.raw=/\\n/]",
          message: "The server sends scripts without indentation, also of text of several lines.",
        },
      ],
      "no-var": "error",
      "object-shorthand": "error",
      "prefer-const": "error",
    },
  },
  { files: ["static/**", "docs/assets/**"], languageOptions: { globals: globals.browser } },
  { files: ["tests/page/**", "*.js"], languageOptions: { globals: globals.node } },
];
