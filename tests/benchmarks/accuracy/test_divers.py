"""The report on published sets of divers' signs."""

from contextlib import closing
from pathlib import Path

from app.evaluation.labelled_takes import ClipRecorder
from benchmarks.accuracy.divers import report
from benchmarks.sets.divers.published_sets import find_set
from tests.benchmarks.sets.divers.folders import write_scubanet, write_sdg11


def _report(folder: Path, keep: Path) -> list[str]:
    with closing(ClipRecorder(keep)) as recorder:
        takes = list(find_set(folder).reads(folder, recorder))
    return list(report(takes, draws=2, queries=10, seed=1))


def test_queries_from_another_setting_are_counted_apart(tmp_path: Path) -> None:
    write_sdg11(tmp_path / "set", tmp_path / "kept")
    lines = _report(tmp_path / "set", tmp_path / "kept")
    assert lines[0] == "3 signs, 6 takes of them, 0 without a sign"
    assert lines[1].startswith("can be a demonstration: 100.0%")
    assert [line.split()[:2] for line in lines[2:]] == [["full", "other"], ["paper", "other"]]
    assert all("n = 6" in line for line in lines[2:])


def test_takes_without_a_sign_are_asked_for_false_alarms(tmp_path: Path) -> None:
    write_scubanet(tmp_path / "set", tmp_path / "kept")
    lines = _report(tmp_path / "set", tmp_path / "kept")
    assert lines[0] == "3 signs, 6 takes of them, 3 without a sign"
    kinds = [" ".join(line.split()[:2]) for line in lines[2:]]
    assert kinds == ["full alike", "full no", "paper alike", "paper no"]
    assert any("false alarms" in line for line in lines)
