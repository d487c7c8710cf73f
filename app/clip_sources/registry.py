"""Registry of clip sources: a new kind of file is a new entry of `SOURCES`."""

from __future__ import annotations

from pathlib import Path

from app.clip_sources.bag import BagSource
from app.clip_sources.keypoint_file import KeypointFileSource
from app.clip_sources.source import ClipSource
from app.clip_sources.video import ChaptersSource, VideoSource
from app.recognition.errors import VideoError
from app.recognition.recording.file_kinds import COPIES, FileKind
from app.recognition.text.wording import join_words

VIDEO, CHAPTERS = VideoSource(), ChaptersSource()

SOURCES: tuple[ClipSource, ...] = (VIDEO, CHAPTERS, BagSource(), KeypointFileSource())
"""All kinds of files that become clips, in the order in which they are tried."""


def source_named(name: str) -> ClipSource:
    """Return the source of that name; raise KeyError when there is none."""
    return {source.name: source for source in SOURCES}[name]


def sources_of_upload(head: bytes, name: str) -> list[ClipSource]:
    """Return the sources that a received file may be of, by its first bytes and its name."""
    return [source for source in SOURCES if source.accepts_upload(head, name)]


def source_of(path: Path, topic: str | None = None) -> ClipSource:
    """Return the source that reads a file or folder.

    A file that no source recognises is read as a video; the video reader then explains the fault.

    Raises
    ------
    VideoError
        When there is nothing at `path`, or a folder that no source recognises.

    """
    if not path.exists():
        raise VideoError(f"{path} is not a file; give the path of a clip")
    for source in SOURCES:
        if source.accepts(path, topic):
            return source
    if path.is_dir():
        marks = [source.folder for source in SOURCES if source.folder is not None]
        raise VideoError(
            f"{path} holds neither {join_words(marks, 'nor')}; give the folder that holds one of "
            "them"
        )
    return VIDEO


def is_copy(path: Path) -> bool:
    """Return whether a file is a small or unfinished copy of a clip that lies beside it."""
    if path.suffix.lower() not in COPIES:
        return False
    name = path.name.split(".")[0]
    # GoPro's copy of GX010042.MP4 is GL010042.LRV.
    stems = {name, *(kind + name[2:] for kind in ("GX", "GH") if name.startswith("GL"))}
    endings = [*VIDEO.endings, *(ending.upper() for ending in VIDEO.endings)]
    return any(path.with_name(stem + end).is_file() for stem in stems for end in endings)


def is_take(path: Path) -> bool:
    """Return whether `path`, in a folder of labelled takes, is a take, and no copy of one."""
    return not is_copy(path) and any(source.is_take(path) for source in SOURCES)


def supported_kinds(kind: FileKind | None = None) -> str:
    """Return, in words, that a file is of no kind that is read, and which kinds to send instead.

    Parameters
    ----------
    kind
        What the file is; None: unknown.

    """
    nouns = join_words(list(dict.fromkeys(source.noun for source in SOURCES)), "nor")
    formats = join_words(list(dict.fromkeys(source.formats for source in SOURCES)), "or")
    if kind is not None:
        return (
            f"{kind.name}, which holds no clip that is read here; {kind.remedy}, or send {formats}"
        )
    return f"neither {nouns} this app knows, whatever its name says; send {formats}"
