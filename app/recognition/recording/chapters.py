"""Chapters: the files into which a camera splits one recording, and how they become one clip."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from datetime import datetime
from itertools import pairwise, starmap
from pathlib import Path
from typing import Final

import av
from av.container import OutputContainer
from av.video.stream import VideoStream

from app.recognition.errors import VideoError
from app.recognition.recording.file_kinds import COPIES
from app.recognition.recording.video import ByteRange, nominal_step, open_video, video_stream
from app.recognition.recording.video_limits import VideoLimits

_GOPRO: Final = re.compile(r"(G[HXLP])(\d\d)(\d{4}\.\w+)", re.IGNORECASE)

_NAMES: Final = (
    _GOPRO,
    re.compile(r"(DJI_)(?:\d{14}_)?(\d{4})((?:_[A-Z])?\.\w+)", re.IGNORECASE),
    re.compile(r"(.*?)(\d{8}_?\d{6})(\.\w+)"),
    re.compile(r"(.*?)(\d+)(\.\w+)"),
)
"""Names of chapters of GoPro, of DJI, and of all that begin a file every minute, by its time or its
number: what comes before the number, the number, and what follows."""

_NUMBERED: Final = re.compile(r"\d{4,}")
"""Digits of numbers that are told to go on in the next file; fewer are in names of any kind."""

_Span = tuple[float, float, tuple[object, ...]]
"""Begin and end of a video in seconds of its container's clock, and how it is coded."""

_BESIDE: Final = COPIES | {".srt", ".thm"}
"""Endings of what cameras write beside a chapter."""

_TIME: Final = 14
"""Digits of a time, after which no name is known to be next."""

SEAM_SECONDS: Final = 2.0
"""Most seconds between the end of a chapter and the beginning of the next one, as containers say,
which count whole seconds."""


def _match(name: str, names: Sequence[re.Pattern[str]]) -> re.Match[str] | None:
    """Match a name; until 2017 GoPro's first chapter was called ``GOPR``, and the next ``GP01``."""
    plain = re.sub(r"^GOPR(?=\d{4}\.)", "GP00", name, flags=re.IGNORECASE)
    return next(filter(None, (each.fullmatch(plain) for each in names)), None)


def tell_chapters(name: str) -> Iterator[str]:
    """Return a sentence where a clip's name says that a take may begin or end in another file."""
    found = _match(name, _NAMES)
    # Other programs name their MP4 files so as well.
    if (
        found is None
        or len(found[2]) >= _TIME
        or (found.re in _NAMES[2:] and found[3].lower() != ".ts")
        or not (found.re is _GOPRO or _NUMBERED.fullmatch(found[2]))
    ):
        return
    goes_on = found.re is not _GOPRO or int(found[2]) <= (found[1].upper() != "GP")
    number = f"{int(found[2]) + (1 if goes_on else -1):0{len(found[2])}d}"
    before = re.sub(r"\d{14}", "…", found.string[: found.start(2)])
    other = re.sub("^GP00", "GOPR", f"{before}{number}{found[3]}")
    where = "may go on in" if goes_on else "is a chapter of a recording that begins in"
    yield (
        f"{name} {where} {other}; a take across both is read once both are one clip: drop them on "
        "the page together, or name a folder that holds them alone"
    )


def in_order(files: Sequence[Path], names: Sequence[re.Pattern[str]]) -> list[Path]:
    """Return files by their numbers, if these alone tell their names apart; else nothing.

    Parameters
    ----------
    files
        The files, of which none may be missing in the middle.
    names
        Patterns, each with three groups: what comes before the number, the number, what follows.

    """
    found = [(each, path) for path in files if (each := _match(path.name, names))]
    numbered = sorted((int(each[2]), path) for each, path in found)
    same = len({(each.re, each[1], each[3]) for each, _ in found}) == 1
    steps = pairwise(number for number, _ in numbered)
    follow = all(number == last + 1 or last >= 10 ** (_TIME - 1) for last, number in steps)
    whole = same and follow and len(files) == len(found) > 1
    return [path for _, path in numbered] if whole else []


def chapters_in(folder: Path) -> list[Path]:
    """Return a folder's files in order, if they are all chapters of one recording; else nothing.

    GoPro's are known by their names. Of other cameras, each chapter must begin when the one before
    it ends, as their containers say; videos of consecutive numbers may be recordings of their own.
    """
    visible = [each for each in folder.iterdir() if not each.name.startswith(".")]
    found = in_order([each for each in visible if each.suffix.lower() not in _BESIDE], _NAMES)
    sure = all(_match(each.name, [_GOPRO]) for each in found)
    return found if sure or all(starmap(_follows, pairwise(map(_span, found)))) else []


def tell_pieces(files: Sequence[Path]) -> Iterator[str]:
    """Yield a sentence for files whose clocks follow each other, and which are clips of their own.

    Parameters
    ----------
    files
        The clips of a folder.

    """
    runs: dict[tuple[Path, str, str], list[Path]] = {}
    for path in files:
        if path.is_file() and (found := _match(path.name, _NAMES)) is not None:
            runs.setdefault((path.parent, found[1], found[3]), []).append(path)
    for run in runs.values():
        pieces = in_order(run, _NAMES)
        if any(starmap(_follows, pairwise(map(_span, pieces)))):
            yield (
                f"{pieces[0].name} to {pieces[-1].name}, {len(pieces)} files that may be one "
                "recording: join them? Put them alone into a folder, or drop them on the page"
            )


def _follows(earlier: _Span, later: _Span) -> bool:
    """Return whether a video begins when another one ends, and is coded alike."""
    (begun, ended, form), (begins, _, other) = earlier, later
    return begun < begins and abs(ended - begins) <= SEAM_SECONDS and form == other


def _span(path: Path) -> _Span:
    """Return begin and end in seconds of the container's own clock, NaN without one, and the form.

    A date of creation is of whole seconds; without one, time goes on from file to file.
    """
    with suppress(ValueError, VideoError), open_video(path, VideoLimits()) as container:
        stated = container.metadata.get("creation_time")
        begun = (container.start_time or 0) / av.time_base
        seconds = (container.duration or 0) / av.time_base
        # Matroska counts its length from 0, not from its first frame.
        if "matroska" in container.format.name and begun < seconds:
            seconds -= begun
        if stated is not None and container.format.name != "mpegts":
            begun = datetime.fromisoformat(stated.replace("Z", "+00:00")).timestamp()
        return begun, begun + seconds, _form(video_stream(container, path))
    return math.nan, math.nan, ()


def _form(stream: VideoStream) -> tuple[object, ...]:
    """Return how a video is coded; parameter sets that differ by zeros at their end are the same.

    Such zeros are padding (ITU-T H.264, annex B).
    """
    coded = stream.codec_context
    sets = [each.rstrip(b"\0") for each in (coded.extradata or b"").split(b"\0\0\1")]
    return coded.name, coded.width, coded.height, stream.time_base, *sets


def join_chapters(chapters: Sequence[tuple[Path, ByteRange | None]], target: Path) -> None:
    """Write the pictures of several videos as one MP4, one after the other, without coding them.

    Parameters
    ----------
    chapters
        The files in order, each with the bytes that are the video; None for all.
    target
        The file to write. It has no sound.

    Raises
    ------
    VideoError
        When a chapter cannot be read or is coded otherwise than the first one, or MP4 does not hold
        its codec.
    OSError
        When the file cannot be written.

    """
    try:
        with av.open(str(target), "w", format="mp4") as joined:
            _join(chapters, joined)
    except (VideoError, OSError):  # The disk may be full.
        raise
    except (ArithmeticError, ValueError, av.error.FFmpegError) as error:
        raise VideoError(f"the chapters cannot be joined ({error}); convert them to MP4") from error


def _join(chapters: Sequence[tuple[Path, ByteRange | None]], joined: OutputContainer) -> None:
    first = None
    # In the unit of time of the first chapter, which the others share.
    end, last = 0, -(2**62)
    for path, within in chapters:
        with open_video(path, VideoLimits(), within) as container:
            stream = video_stream(container, path)
            form = _form(stream)
            if first is None:
                written, first = joined.add_stream_from_template(stream), form
            if form != first:
                here, there = (f"{each[1]} x {each[2]} {each[0]}" for each in (form, first))
                if here == there:
                    here, there = "another clock or other parameter sets", here
                raise VideoError(
                    f"a chapter ({here}) is coded otherwise than the first one ({there}); give "
                    "each clip by itself"
                )
            shift = None
            step = round(nominal_step(stream) / (stream.time_base or 1))
            for packet in container.demux(stream):
                if packet.pts is not None:
                    shift = end - packet.pts if shift is None else shift
                    dts = packet.pts if packet.dts is None else packet.dts
                    # Where the order of decoding differs, chapters overlap in it.
                    last = packet.dts = max(dts + shift, last + 1)
                    packet.pts = max(packet.pts + shift, packet.dts)
                    end = max(end, packet.pts + (packet.duration or step))
                    packet.stream = written
                    joined.mux(packet)
