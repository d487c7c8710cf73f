"""Downloads have names that a shell takes without quotes, and come in ranges."""

import httpx
import pytest

from app.api.http.downloads import attachment
from tests.api.routes.clips.test_clips import CLIPS
from tests.api.running import assert_problem
from tests.api.shared_server import server, settings

__all__ = ["server", "settings"]


@pytest.mark.parametrize(
    ("name", "shown"),
    [
        ("My gestures", "My-gestures.json"),
        ("Zeichen für Höhlen, 2. Fassung ✋", "Zeichen-fur-Hohlen-2.-Fassung.json"),
        ('"; rm -rf ~\r\nX: y', "rm--rf-X-y.json"),
        ("手势", "language.json"),
    ],
)
def test_a_name_is_one_word_of_a_command(name: str, shown: str) -> None:
    assert attachment(name, ".json") == f'attachment; filename="{shown}"'


@pytest.mark.parametrize(
    ("asked", "status", "content_range", "length"),
    [
        ("bytes=0-99", 206, "bytes 0-99/1024", 100),
        ("bytes=1000-", 206, "bytes 1000-1023/1024", 24),
        ("bytes=-24", 206, "bytes 1000-1023/1024", 24),
        ("bytes=1000-9999", 206, "bytes 1000-1023/1024", 24),
        ("bytes=5-2", 200, None, 1024),
        ("bytes=x", 200, None, 1024),
        ("lines=0-1", 200, None, 1024),
        ("bytes=" + ",".join(f"{i}-{i}" for i in range(5000)), 200, None, 1024),
    ],
    ids=["first", "open", "last", "beyond", "reversed", "garbage", "unit", "thousands"],
)
@pytest.mark.withstands(row="H17")
def test_a_video_is_sent_in_ranges(
    client: httpx.Client,
    circle_clip: str,
    asked: str,
    status: int,
    content_range: str | None,
    length: int,
) -> None:
    answer = client.get(f"{CLIPS}/{circle_clip}/video", headers={"Range": asked})
    assert answer.status_code == status
    assert answer.headers.get("content-range") == content_range
    assert len(answer.content) == length
    assert answer.headers["content-type"] == "video/mp4"


@pytest.mark.parametrize("asked", ["bytes=1024-", "bytes=99999-100000", "bytes=-0"])
def test_a_range_outside_the_file_is_416(
    client: httpx.Client, circle_clip: str, asked: str
) -> None:
    answer = client.get(f"{CLIPS}/{circle_clip}/video", headers={"Range": asked})
    assert_problem(answer, 416, "range_not_satisfiable")
    assert answer.headers["content-range"] == "bytes */1024"
