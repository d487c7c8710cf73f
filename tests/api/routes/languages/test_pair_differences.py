"""Two gestures side by side over HTTP."""

import httpx
import pytest

from tests.api.running import assert_problem
from tests.recognition.demonstrations import pool
from tests.recognition.strategies import circle, line

LANGUAGES = "/api/v1/languages"


@pytest.fixture
def contrast(client: httpx.Client) -> str:
    document = pool(circle=circle, line=line).to_json()
    answer = client.post(f"{LANGUAGES}/import", content=document)
    return f"{LANGUAGES}/{answer.json()['id']}/contrast"


def test_corresponding_moments_lie_within_both_demonstrations(
    client: httpx.Client, contrast: str
) -> None:
    found = client.get(contrast, params={"one": "line", "other": "circle"}).json()
    line_shown, circle_shown = found["gestures"]
    assert [line_shown["label"], circle_shown["label"]] == ["line", "circle"]
    alignment = found["alignment"]
    for side, shown, clock in ((0, line_shown, "time"), (1, circle_shown, "gesture_time")):
        seconds = [alignment[clock][pair[side]] for pair in alignment["pairs"]]
        assert min(seconds) >= 0
        assert max(seconds) <= shown["time"][-1] + 1e-3
        for landmark in shown["salient"]:
            assert len(shown["paths"][landmark]) == len(shown["time"])
    assert all(found["differs"])


def test_an_unknown_gesture_is_404(client: httpx.Client, contrast: str) -> None:
    answer = client.get(contrast, params={"one": "line", "other": "square"})
    assert_problem(answer, 404, "not_found")
