"""Worker messages: they survive the way through the pipe; other data is refused."""

import pytest

from app.api.workers.worker_messages import (
    LAST,
    MORE,
    Failed,
    Finished,
    Message,
    Probed,
    Progressed,
    dump,
    parse,
)


@pytest.mark.parametrize(
    "message",
    [
        Probed(width=64, height=48, duration=None, frames=3),
        Progressed(stage="saving", done=9, total=9),
        Progressed(stage="poses", done=1, total=9, time=0.04, pose=((0.5, -0.25), None)),
        Finished(frames=9, warnings=("no hand in any of 9 frames\n\u2028",)),
        Failed(code="decoder", detail="broke"),
    ],
    ids=lambda message: message.kind,
)
def test_a_message_is_one_line_and_comes_back(message: Message) -> None:
    (line,) = dump(message)
    assert "\n" not in line
    assert parse(line.encode()) == message


def test_a_long_message_is_sent_in_lines_that_every_reader_takes() -> None:
    message = Finished(result={"name": "\U0001f93f+=" * 40_000})
    *parts, last = (line.encode() for line in dump(message))
    assert max(map(len, [*parts, last])) < 64 * 1024
    assert {line[:1] for line in parts} == {MORE}
    assert last[:1] == LAST
    assert parse(b"".join(line[1:] for line in (*parts, last))) == message


@pytest.mark.parametrize(
    "line",
    [
        b"",
        b"{",
        b"{}",
        b'{"kind": "hello"}',
        b'{"kind": "failed"}',
        # What no database or no browser could take.
        b'{"kind": "failed", "code": "<b>", "detail": ""}',
        b'{"kind": "finished", "frames": 2147483648, "warnings": []}',
        b'{"kind": "finished", "frames": -1, "warnings": []}',
        b'{"kind": "probed", "width": -1, "height": 48, "duration": null, "frames": 3}',
        b'{"kind": "probed", "width": 64, "height": 48, "duration": Infinity, "frames": 3}',
        b'{"kind": "progressed", "stage": "poses", "done": 1, "total": 9, "time": NaN}',
        b'{"kind": "progressed", "stage": "poses", "done": 1, "total": 9, "pose": [[0, NaN]]}',
    ],
)
def test_what_is_no_message_is_an_error(line: bytes) -> None:
    with pytest.raises(ValueError, match="validation error"):
        parse(line)


def test_a_text_is_one_that_every_database_takes() -> None:
    said = parse(rb'{"kind": "failed", "code": "decoder", "detail": "topic /a\u0000b is empty"}')
    assert isinstance(said, Failed)
    assert said.detail == "topic /a\ufffdb is empty"
