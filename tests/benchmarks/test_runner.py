"""The runner: what is measured, what of it is kept, and what is said of bad input."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks.figures import Measured, Results
from benchmarks.runner import (
    BenchError,
    Journal,
    Order,
    choose,
    main,
    run,
    write_results,
)
from tests.conftest import ROOT

COMMIT, OTHER = "a" * 40, "b" * 40
TREES = {"app/recognition": "same"}


def small(folder: Path | None = None, *methods: str) -> Order:
    return Order(folder, quick=True, methods=methods, topics=("tests.benchmarks.small_topic",))


def run_small(order: Order, journal: Journal, *only: str) -> bool:
    chosen = [*choose(order.measurements().values(), only)]
    return run(order, chosen, journal, Results({}), TREES)


def test_the_same_seeds_give_the_same_figures(tmp_path: Path) -> None:
    files = []
    (tmp_path / "set.npz").write_bytes(b"recordings")
    for name in ("one", "two"):
        journal = Journal(tmp_path / f"{name}.jsonl", COMMIT)
        assert run_small(small(tmp_path), journal, "small/swipes", "recorded/set")
        files.append(tmp_path / f"{name}.json")
        write_results(files[-1], Results(journal.measured, TREES))
    one, two = (json.loads(each.read_text("utf-8")) for each in files)
    assert one["hash"] == two["hash"]
    assert one["measurements"].keys() == {"small/swipes", "recorded/set"}
    figures = one["measurements"]["small/swipes"]["figures"]
    assert figures["same"]["value"] > 0.5
    assert figures == two["measurements"]["small/swipes"]["figures"]
    other = Results({"recorded/set": journal.measured["small/swipes"]}, TREES)
    write_results(files[0], other)
    assert json.loads(files[0].read_text("utf-8"))["hash"] != two["hash"]


@pytest.mark.slow
def test_a_measurement_that_fails_is_named_and_the_others_are_kept(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "journal.jsonl"
    wanted = ("small/fails", "small/killed", "small/swipes", "small/numbers")
    assert not run_small(small(), Journal(path, COMMIT), *wanted)
    said = capsys.readouterr().out
    assert "small/fails failed: " in said
    assert "ValueError: the camera was under water" in said
    (killed,) = (line for line in said.splitlines() if "small/killed" in line)
    assert killed.endswith("its process was killed, as the system does when memory runs out.")
    assert Journal(path, COMMIT).measured.keys() == {"small/swipes", "small/numbers"}


@pytest.mark.slow
def test_a_run_goes_on_where_it_was_broken_off(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "journal.jsonl"
    assert run_small(small(), Journal(path, COMMIT), "small/numbers")
    with path.open("a", encoding="utf-8") as file:
        file.write('{"name": "small/swipes", "measured": {"da')
    journal = Journal(path, COMMIT)
    assert f"Line 2 of {path} is damaged and is not read." in capsys.readouterr().out
    assert run_small(small(), journal, "small/swipes", "small/numbers")
    said = capsys.readouterr().out
    assert "1 of 2 are in the journal." in said
    assert "2 of 2: small/swipes" in said
    assert Journal(path, COMMIT).measured.keys() == journal.measured.keys()


def test_a_journal_of_another_commit_is_set_aside(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "journal.jsonl"
    measured = Measured("none", "drawn", None, "", COMMIT, TREES, 1.0, None)
    Journal(path, COMMIT).keep("small/numbers", measured)
    journal = Journal(path, OTHER)
    assert journal.measured == {}
    assert "is kept as journal-aaaaaaaa.jsonl" in capsys.readouterr().out
    journal.keep("small/numbers", Measured("none", "", None, "", OTHER, TREES, 1.0, None))
    Journal(path, COMMIT).keep("small/swipes", measured)
    Journal(path, OTHER)
    aside = Journal(tmp_path / "journal-aaaaaaaa.jsonl", COMMIT)
    assert aside.measured.keys() == {"small/numbers", "small/swipes"}


def test_what_reads_a_missing_file_is_left_out_by_name(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "set.npz").write_bytes(b"")
    chosen = [each.name for each in choose(small(tmp_path).measurements().values(), ["recorded"])]
    assert chosen == ["recorded/set"]
    missing = tmp_path / "missing.npz"
    assert capsys.readouterr().out == f"recorded/missing is left out: {missing} is not there.\n"


def test_a_name_of_nothing_is_refused_with_the_topics() -> None:
    with pytest.raises(BenchError, match=r"nothing is called smal\. Topics: small, recorded"):
        [*choose(small().measurements().values(), ["smal"])]


@pytest.mark.slow
def test_a_method_that_cannot_learn_is_named_and_the_others_have_their_figures(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    journal = Journal(tmp_path / "journal.jsonl", COMMIT)
    method = "tests.benchmarks.small_topic:Failing"
    assert run_small(small(None, method), journal, "small/compared")
    said = capfd.readouterr().out
    assert f"{method} has no figures of swipes: ZeroDivisionError of `fit`" in said
    figures = journal.measured["small/compared"].figures
    assert {name.partition("/")[0] for name in figures} == {"full"}


def bench(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    """Run the command with arguments that it refuses; return what it says."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(sys, "argv", ["benchmarks", *words])
        with pytest.raises(SystemExit) as ended:
            main()
    assert ended.value.code == 2
    return " ".join("".join(capsys.readouterr()).split())


def test_a_folder_without_sets_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    said = bench(capsys, str(tmp_path), "--quick", "--only", "comparison")
    assert f"comparison/digits is left out: {tmp_path / 'trajectories' / 'madlab3d.npz'}" in said
    assert "nothing can be measured without these; which sets there are: docs/bench.md" in said
    said = bench(capsys, str(tmp_path / "nowhere"))
    assert said.endswith(f"{tmp_path / 'nowhere'} is not a folder.")


def test_a_copy_without_git_is_told_that_it_is_needed(tmp_path: Path) -> None:
    (tmp_path / "benchmarks").symlink_to(ROOT / "benchmarks")
    command = "from benchmarks import figures, runner; from pathlib import Path; "
    command += f"runner.ROOT = Path({str(tmp_path)!r}); runner.main()"
    ended = subprocess.run(
        [sys.executable, "-c", command, "--only", "crashes"], capture_output=True, text=True
    )
    assert ended.returncode == 2
    assert "the bench needs a checkout and git: fatal: not a git repository" in ended.stderr
