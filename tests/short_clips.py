"""Copies of clips with fewer frames: finding poses takes long, frame by frame."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import av


def shortened(clip: Path, copy: Path, seconds: float) -> Path:
    """Write the first seconds of a clip, its pictures as they are, and return the copy's path."""
    with av.open(str(clip)) as source, av.open(str(copy), "w") as target:
        stream = source.streams.video[0]
        written = target.add_stream_from_template(stream)
        for packet in source.demux(stream):
            if packet.pts is None or packet.time_base is None:
                continue
            if packet.pts * packet.time_base > seconds:
                break
            packet.stream = written
            target.mux(packet)
    return copy


def in_chapters(clip: Path, *chapters: Path) -> tuple[Path, ...]:
    """Write a clip as files that follow each other, each with a clock of its own; return them."""
    with av.open(str(clip)) as source:
        stream = source.streams.video[0]
        assert stream.duration is not None
        targets = [av.open(str(chapter), "w") for chapter in chapters]
        written = [target.add_stream_from_template(stream) for target in targets]
        begun = [0] * len(chapters)
        now = -1
        for packet in source.demux(stream):
            if packet.pts is None or packet.dts is None:
                continue
            due = len(chapters) * packet.pts // stream.duration
            if packet.is_keyframe and due > now:
                now += 1
                begun[now] = packet.pts
            packet.pts, packet.dts = packet.pts - begun[now], packet.dts - begun[now]
            packet.stream = written[now]
            targets[now].mux(packet)
        for target in targets:
            target.close()
    return chapters


def thinned(
    clip: Path,
    copy: Path,
    times: int = 1,
    *,
    every: int = 3,
    backward: bool = False,
    share: float = 1.0,
) -> Path:
    """Write every third frame of a clip at a third of its rate, and return the copy's path.

    With `times`, the clip follows itself; `backward` begins at its end; `share` ends it early.
    """
    with av.open(str(clip)) as source, av.open(str(copy), "w") as target:
        stream = source.streams.video[0]
        assert stream.average_rate is not None
        rate = Fraction(stream.average_rate) / every
        written = target.add_stream("libx264", rate=rate, options={"crf": "20", "g": "15"})
        written.width, written.height, written.pix_fmt = stream.width, stream.height, "yuv420p"
        kept = list(source.decode(stream))[::every]
        kept = kept[: round(share * len(kept))]
        for number, frame in enumerate(times * (kept[::-1] if backward else kept)):
            frame.pts, frame.time_base = number, 1 / rate
            target.mux(written.encode(frame))
        target.mux(written.encode())
    return copy
