"""Formats of language files that can be written."""

from __future__ import annotations

from enum import Enum

from app.recognition.language.language import Language
from app.recognition.language.osg_reference import to_reference
from app.recognition.language.proteus import SUFFIX as PROTEUS_SUFFIX
from app.recognition.language.proteus import to_proteus


class FileFormat(str, Enum):
    """The language files."""

    OSG_STUDIO = "osg-studio"
    """OSG Studio's own format: everything."""
    OSG_REFERENCE = "osg-reference"
    """The published implementation's: images and salient keypoints only."""
    PROTEUS = "proteus"
    """A PROTEUS language definition file: names and kinds of the gestures only."""

    @property
    def media_type(self) -> str:
        """Media type, such as application/json."""
        return "application/xml" if self is FileFormat.PROTEUS else "application/json"

    @property
    def suffix(self) -> str:
        """Ending of the name of a file of the format."""
        return PROTEUS_SUFFIX if self is FileFormat.PROTEUS else ".json"

    def write(self, language: Language) -> str:
        """Return the content of a file of the format."""
        if self is FileFormat.OSG_REFERENCE:
            return to_reference(language)
        return to_proteus(language) if self is FileFormat.PROTEUS else language.to_json()
