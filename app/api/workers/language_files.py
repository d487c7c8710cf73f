"""Language files in a worker process: import and check; either may take minutes for a large one."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

from pydantic import BaseModel

from app.api.workers.worker_messages import Finished, Message, Progressed
from app.recognition import Language
from app.recognition.health.check import check_health
from app.recognition.language.osg_reference import from_reference, is_reference
from app.resources import known_signs_file

REPORT_EVERY = 8
"""Number of steps between two reports, each a take or movement of some ten milliseconds: ten
reports a second are enough for a smooth progress bar."""

Report = Callable[[Message], None]


class ImportedLanguage(BaseModel):
    """A language file that was read.

    Attributes
    ----------
    name, author, labels, revision
        Values in the file.
    change
        Description of the import, for the history.
    document
        The same language in our own format.

    """

    name: str
    author: str
    labels: list[str]
    revision: int
    change: str
    document: str


def read_language(content: bytes, name: str) -> ImportedLanguage:
    """Read a language file in our format, or in the published implementation's, then named `name`.

    Raises
    ------
    LanguageError
        When the file is neither.

    """
    if is_reference(content):
        language, change = from_reference(content, name), "Import of an osg-reference file"
    else:
        language, change = Language.from_json(content), "Import"
    return ImportedLanguage(
        name=language.name,
        author=language.author,
        labels=list(language.labels),
        revision=language.revision,
        change=change,
        document=language.to_json(),
    )


def import_language(file: Path, target: Path, name: str, report: Report) -> None:
    """Read a language file, and write the `ImportedLanguage` to `target` as JSON."""
    target.write_text(read_language(file.read_bytes(), name).model_dump_json(), encoding="utf-8")
    report(Finished(frames=0, warnings=()))


def check_language(file: Path, target: Path, report: Report) -> None:
    """Check the language of a file, and write the health report to `target` as JSON."""

    def progress(stage: str, done: int, total: int) -> None:
        if done % REPORT_EVERY == 1:
            report(Progressed(stage=stage, done=done, total=total))

    checked = check_health(
        Language.from_json(file.read_bytes()),
        progress=progress,
        known_signs=Language.load(known_signs_file()),
    )
    target.write_text(json.dumps(checked.to_dict()), encoding="utf-8")
    report(Finished(frames=0, warnings=()))
