"""A language file is read again when it was replaced, or when somebody asks."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from app.recognition import LanguageError, OsgError
from app.recognition.gestures.profile import Tuning
from app.robot import ActiveLanguage
from app.robot.active_language import POLL_INTERVAL, LanguageWatcher
from tests.robot.languages import language_of, spoken

PATIENCE = 60.0
"""Seconds until a test gives up; the change is noticed within two checks of the file."""


def save(path: Path, *labels: str, revision: int = 1) -> ActiveLanguage:
    language_of(*labels, revision=revision).save(path)
    return spoken(*labels, revision=revision)


def news(watcher: LanguageWatcher) -> ActiveLanguage | OsgError:
    end = clock.monotonic() + PATIENCE
    while clock.monotonic() < end:
        if change := watcher.next_change():
            return change
        clock.sleep(0.05)
    raise AssertionError("no language was loaded or refused")


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "pool.json"


def test_the_first_language_has_the_seal_of_its_file(file: Path) -> None:
    saved = save(file, "circle")
    with LanguageWatcher(file) as watcher:
        assert watcher.first.sha256 == saved.sha256
        assert f'"sha256": "{saved.sha256}"' in file.read_text()
        assert watcher.next_change() is None


def test_a_language_is_heard_as_its_author_kept_it_unless_told_otherwise(file: Path) -> None:
    tuned = replace(language_of("circle"), profile="paper", tuning=Tuning(weights={"hu": 0.0}))
    tuned.save(file)
    with LanguageWatcher(file) as watcher:
        recognizer = watcher.first.recognizer
        assert (recognizer.profile, recognizer.tuning) == ("paper", tuned.tuning)
    with LanguageWatcher(file, "full") as watcher:
        assert watcher.first.recognizer.profile == "full"


def test_a_replaced_file_is_read_and_told_once(file: Path) -> None:
    save(file, "circle")
    with LanguageWatcher(file) as watcher:
        saved = save(file, "circle", "line", revision=2)
        change = news(watcher)
        assert isinstance(change, ActiveLanguage)
        assert (change.sha256, change.revision) == (saved.sha256, 2)
        clock.sleep(3 * POLL_INTERVAL)
        assert watcher.next_change() is None


@pytest.mark.parametrize(
    ("spoil", "reason"),
    [
        (lambda file: file.write_text('{"format": '), "not JSON"),
        (lambda file: file.write_text("{}"), "/format"),
        (lambda file: file.unlink(), "cannot read"),
    ],
    ids=["cut short", "another file", "gone"],
)
def test_a_broken_file_is_told_once_and_its_successor_is_spoken(
    file: Path, spoil: Callable[[Path], object], reason: str
) -> None:
    save(file, "circle")
    with LanguageWatcher(file) as watcher:
        spoil(file)
        refused = news(watcher)
        assert isinstance(refused, LanguageError)
        assert reason in str(refused)
        save(file, "circle", "line", revision=2)
        change = news(watcher)
        assert isinstance(change, ActiveLanguage)
        assert change.revision == 2


def test_who_asks_is_answered_also_when_nothing_changed(file: Path) -> None:
    saved = save(file, "circle")
    with LanguageWatcher(file) as watcher:
        watcher.reload()
        change = news(watcher)
    assert isinstance(change, ActiveLanguage)
    assert change.sha256 == saved.sha256
