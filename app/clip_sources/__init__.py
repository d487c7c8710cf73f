"""Clip sources: the kinds of files and folders that clips are made of, one module each."""

from app.clip_sources.registry import (
    CHAPTERS,
    SOURCES,
    VIDEO,
    is_copy,
    is_take,
    source_named,
    source_of,
    sources_of_upload,
    supported_kinds,
)
from app.clip_sources.source import (
    ClipSource,
    ReadOptions,
    Refusal,
    UnsupportedFile,
)
