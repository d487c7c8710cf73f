"""Whole bodies are read from files of metres, and seen as a camera in front sees them."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.sets.whole_body_sets import (
    FIGURES,
    FOCAL,
    UPPER_BODY,
    far_movements,
    whole_body_sets,
)

FRAMES = 6


def save(path: Path, labels: list[str], times: list[float] | None = None) -> None:
    """Save bodies whose joints stand 0.1 m apart, 2 m away, and rise by 0.1 m a frame."""
    places = np.zeros((FRAMES, len(UPPER_BODY), 3))
    places[..., 0] = 0.1 * np.arange(len(UPPER_BODY))
    places[..., 1] = 0.1 * np.arange(FRAMES)[:, None]
    places[..., 2] = 2
    x = np.empty(len(labels), dtype=object)
    x[:] = [places for _ in labels]
    content: dict[str, Any] = {} if times is None else {"t": [times] * len(labels)}
    people = np.arange(len(labels))
    np.savez(path, x=x, label=labels, subject=people, joint_names=UPPER_BODY, **content)


def test_figures_are_a_part_of_the_signals(tmp_path: Path) -> None:
    save(tmp_path / "utd_signals.npz", ["clap", *FIGURES, "walk"])
    signals, figures = whole_body_sets(tmp_path, ["utd_signals", "utd_figures"])
    assert [*signals.labels] == ["clap", *FIGURES]
    assert [*figures.labels] == [*FIGURES]
    assert [*figures.people] == ["1", "2", "3", "4", "5", "6"]


def test_a_body_is_seen_by_a_camera_in_front(tmp_path: Path) -> None:
    save(tmp_path / "utd_signals.npz", ["clap"])
    ((seen,),) = [each.recordings for each in whole_body_sets(tmp_path, ["utd_signals"])]
    step = 0.1 / 2 * FOCAL
    assert np.diff(seen.xy[0, :, 0]) == pytest.approx(step)
    assert np.diff(seen.xy[:, 0, 1]) == pytest.approx(-step)
    assert np.diff(seen.time) == pytest.approx(1 / 30)


def test_far_movements_are_no_signals_and_have_times_of_their_own(tmp_path: Path) -> None:
    labels = ["Bow", "Draw-a-circle", "Jump", "Wave-your-hand", "Throw-a-ball"]
    save(tmp_path / "kindergator.npz", labels, [4.0, 4.1, 4.1, 4.2, 4.5, 4.6])
    far = far_movements(tmp_path)
    assert [*far.labels] == ["Bow", "Jump"]
    assert [*far.people] == ["0", "2"]
    assert far.recordings[0].time == pytest.approx([0, 0.1, 0.2, 0.5, 0.6])
    assert len(far.recordings[0].xy) == FRAMES - 1
