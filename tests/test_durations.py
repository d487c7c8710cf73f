"""Which tests the plugin of `make durations` calls long."""

from __future__ import annotations

from types import SimpleNamespace

from tests.durations import LONG_SECONDS, Durations


def test_a_test_is_long_by_all_its_cases_unless_a_mark_leaves_it_out() -> None:
    measured = Durations()

    def report(name: str, share: float, kind: str = "test", **keywords: int) -> None:
        seconds = share * LONG_SECONDS
        lines = [[seconds, seconds, kind, name]]
        measured.pytest_runtest_logreport(
            SimpleNamespace(nodeid=name, keywords=keywords, durations=lines)
        )

    report("test_a.py::test_cases[one]", 0.6)
    report("test_a.py::test_cases[two]", 0.6)
    report("test_a.py::test_with_fixture", 0.6, "function fixture")
    report("test_a.py::test_with_fixture", 0.6)
    report("test_a.py::test_quick", 0.6)
    report("test_a.py::test_first_of_its_module", 2, "module fixture")
    report("test_a.py::test_video", 2, slow=1)
    report("test_a.py::test_poses", 2, models=1)
    assert measured.list_long() == ["test_a.py::test_cases", "test_a.py::test_with_fixture"]
    assert len(measured.lines) == 8
