"""A clip's beginning: finding poses in all of it takes long."""

from __future__ import annotations

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
