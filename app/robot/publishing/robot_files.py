"""Robot files: takes the language file and the vehicle table by upload, after a confirmation.

An upload is read as the robot reads it, compared with the present file, and replaces it only when
the same bytes come again with the token of that comparison.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal, get_args

from app.recognition.errors import LanguageError, OsgError, VehicleError
from app.recognition.language.file import short_code
from app.recognition.text.atomic_files import write_atomically
from app.robot.active_language import ActiveLanguage
from app.robot.mavlink.table import (
    VehicleTable,
    describe_actions,
    parse_vehicle_table,
    read_vehicle_table,
)

FileKind = Literal["language", "vehicle"]

FILE_KINDS: Final[tuple[FileKind, ...]] = get_args(FileKind)

MOST_BYTES: Final = 8_000_000
"""Largest upload: a language of two hundred gestures."""


@dataclass(frozen=True)
class Proposal:
    """What an upload would change.

    Attributes
    ----------
    changes
        One line each, those of emergencies first; empty for the file that is there.
    token
        Confirms these changes.

    """

    changes: tuple[str, ...]
    token: str


class RobotFiles:
    """The files that a robot takes by upload.

    Parameters
    ----------
    language
        Path of the language file; it may be missing.
    vehicle
        Path of the vehicle table; None: the robot commands no vehicle.
    profile
        The recogniser's profile; None: each language's own.
    notify
        Called with the kind of each file that was replaced.
    find_obstacle
        Called with the kind of a file; returns why it must not be replaced now, empty if it may.

    Attributes
    ----------
    most_bytes
        Largest upload.

    """

    most_bytes = MOST_BYTES

    def __init__(
        self,
        language: Path,
        vehicle: Path | None,
        profile: str | None,
        notify: Callable[[FileKind], None],
        find_obstacle: Callable[[FileKind], str] = lambda kind: "",
    ) -> None:
        self._paths: dict[FileKind, Path | None] = {"language": language, "vehicle": vehicle}
        self._profile = profile
        self._notify = notify
        self._find_obstacle = find_obstacle

    def find_path(self, kind: str) -> Path | None:
        """Return the path of a kind of file; None where there is no such file."""
        return next((self._paths[each] for each in FILE_KINDS if each == kind), None)

    def list_missing(self) -> list[FileKind]:
        """Return the kinds of the files that are not there."""
        return [
            kind for kind, path in self._paths.items() if path is not None and not path.is_file()
        ]

    def list_actions(self) -> list[dict[str, str]]:
        """Return what the present vehicle table would send for each of its gestures and phrases.

        Each entry has ``role`` (emergency, gesture or phrase), ``name``, ``does`` and ``sends``.
        Nothing is sent. Empty without a valid table.
        """
        table = self._read_table()
        if table is None:
            return []
        from app.robot.mavlink.actions import describe_sent

        return [
            {
                "role": role,
                "name": name,
                "does": describe_actions(actions),
                "sends": ", else ".join(describe_sent(each, table.vehicle) for each in actions),
            }
            for role, listed in table.list_roles().items()
            for name, actions in listed.items()
        ]

    def propose(self, kind: FileKind, content: bytes) -> Proposal:
        """Compare an upload with the present file.

        Raises
        ------
        OsgError
            When it is not valid.

        """
        if kind == "language":
            new = ActiveLanguage.from_json(content, self._profile)
            changes = (
                *self._list_unfit(self._read_table(), new),
                *self._compare_languages(content),
            )
        else:
            table = parse_vehicle_table(content, self._get_path("vehicle").name)
            unfit = self._list_unfit(table, self._read_language())
            changes = (*compare_tables(self._read_table(), table), *unfit)
        token = hashlib.sha256(self._read(kind) + b"\0" + content + kind.encode()).hexdigest()
        return Proposal(changes, token)

    def replace(self, kind: FileKind, content: bytes, token: str) -> Proposal | None:
        """Replace a file by an upload whose changes were confirmed.

        Returns
        -------
        None when it is replaced; otherwise what it would change now, because the token confirms
        other changes.

        Raises
        ------
        OsgError
            When it is not valid, or must not be replaced now.
        OSError
            When it cannot be written; the present file stays.

        """
        proposal = self.propose(kind, content)
        if token != proposal.token:
            return proposal
        if obstacle := self._find_obstacle(kind):
            raise VehicleError(obstacle)
        write_atomically(self._get_path(kind), content)
        self._notify(kind)
        return None

    def _get_path(self, kind: FileKind) -> Path:
        path = self._paths[kind]
        assert path is not None
        return path

    def _read(self, kind: FileKind) -> bytes:
        path = self._paths[kind]
        try:
            return b"" if path is None else path.read_bytes()
        except OSError:
            return b""

    def _read_table(self) -> VehicleTable | None:
        path = self._paths["vehicle"]
        try:
            return None if path is None else read_vehicle_table(path)
        except (OsgError, OSError):
            return None

    def _read_language(self) -> ActiveLanguage | None:
        try:
            return ActiveLanguage.from_json(self._read("language"), self._profile)
        except LanguageError:
            return None

    def _list_unfit(
        self, table: VehicleTable | None, language: ActiveLanguage | None
    ) -> Iterator[str]:
        """Yield what is wrong with a vehicle table in a language."""
        if table is not None and language is None:
            yield "there is no language yet: upload one as well"
        elif table is not None and language is not None:
            for _, fault in table.list_faults(language.recognizer.language):
                yield f"vehicle table: {fault}"

    def _compare_languages(self, content: bytes) -> Iterator[str]:
        """Yield the changes of the language, of emergency gestures first."""
        new = json.loads(content)
        present = self._read_language()
        old = None if present is None else json.loads(self._read("language"))
        if old == new:
            return
        table = self._read_table()
        emergencies = frozenset() if table is None else frozenset(table.emergency)
        changes = list(compare_gestures(old or {}, new))
        for is_emergency in (True, False):
            for label, words in changes:
                if (label in emergencies) == is_emergency:
                    yield f"{'EMERGENCY ' if is_emergency else ''}gesture {label!r}: {words}"
        for key in ("grammar", "trigger", "profile", "tuning"):
            if (old or {}).get(key) != new.get(key):
                yield f"{key} {'changes' if old else 'is set'}"
        code = short_code(ActiveLanguage.from_json(content, self._profile).sha256)
        before = "" if old is None else f", instead of {old['name']!r} {old['revision']}"
        yield f"language {new['name']!r}, revision {new['revision']}, code {code}{before}"


def compare_gestures(old: Mapping[str, Any], new: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield label and change of each gesture in which two language files differ."""
    before = {each["label"]: each for each in old.get("gestures", ())}
    after = {each["label"]: each for each in new["gestures"]}
    for label in dict.fromkeys((*before, *after)):
        if label not in after:
            yield label, "removed"
        elif label not in before:
            command = after[label].get("command")
            yield label, "added" if command is None else f"added, command {command!r}"
        elif before[label] != after[label]:
            commands = [each[label].get("command") for each in (before, after)]
            if commands[0] != commands[1]:
                yield label, f"command {commands[0]!r} becomes {commands[1]!r}"
            if {**before[label], "command": None} != {**after[label], "command": None}:
                yield label, "is shown differently"


def compare_tables(old: VehicleTable | None, new: VehicleTable) -> Iterator[str]:
    """Yield the changes of a vehicle table, of emergencies first."""
    before = {} if old is None else old.list_roles()
    for role, after in new.list_roles().items():
        words = [
            {name: describe_actions(actions) for name, actions in listed.items()}
            for listed in (before.get(role, {}), after)
        ]
        yield from _compare_actions("EMERGENCY" if role == "emergency" else role, *words)
    compared = ("gestures", "phrases", "emergency")
    known = {} if old is None else old.model_dump(exclude=set(compared))
    for key, value in new.model_dump(exclude=set(compared)).items():
        for part, found in value.items() if isinstance(value, dict) else [("", value)]:
            was = known.get(key)
            was = was.get(part) if part and was is not None else was
            name = f"{key}.{part}" if part else key
            if old is not None and was != found:
                yield f"{name}: {was!r} becomes {found!r}"


def _compare_actions(
    role: str, before: Mapping[str, str], after: Mapping[str, str]
) -> Iterator[str]:
    for label in dict.fromkeys((*before, *after)):
        was, becomes = before.get(label, "nothing"), after.get(label, "nothing")
        if was != becomes:
            yield f"{role} {label!r}: {was} becomes {becomes}"
