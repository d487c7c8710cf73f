"""Recognition page: exports a recognition as one HTML file that plays without a server."""

from __future__ import annotations

import base64
import json
from collections.abc import Iterator
from html import escape
from typing import Any, Final

from app.recognition import Recognition
from app.recognition.explanation.explanation import Explanation
from app.recognition.poses.frame import pose_in
from app.recognition.poses.landmarks import SKELETON
from app.recognition.recording.video import read_frames
from app.recognition.text.wording import ask_which
from app.resources import static_dir
from app.ui import charts
from app.ui.palette import read_tokens
from app.ui.panel_style import alias_chart_colours
from app.ui.workspace import Range, WorkspaceView, compared_images, find_salient_motion

MAX_WIDTH = 400
"""Width of a picture in the file, in pixels."""

MAX_PICTURES = 120
"""Most pictures in the file, about 2 MB; longer takes keep every n-th frame."""

JPEG_QUALITY = 72
"""JPEG quality that keeps the file near 2 MB, small enough for an e-mail; at 82 it is 3 MB."""

POLICY: Final = (
    "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'"
)
"""Content security policy: the file is self-contained and may make no request."""


def analysis_page(
    view: WorkspaceView, recognition: Recognition, explanation: Explanation | None
) -> str:
    """Return a recognition, the compared images and its explanation as HTML.

    Parameters
    ----------
    view
        The take that was recognised.
    recognition
        Result of the recognition.
    explanation
        The explanation; None without an expected label.

    Raises
    ------
    PoseError
        When no frame lies in the view's range.
    VideoError
        When the clip cannot be read.

    """
    shown = Range.of(view)
    content = _recording(view, shown)
    charted = "".join(
        (
            charts.verdict(recognition, view.expected),
            charts.vote_table(recognition, view.expected),
            charts.image_row(compared_images(view, recognition, shown.poses)),
        )
    )
    folder = static_dir() / "recognition-page"
    # A script element ends at the first "</", even inside a JSON string.
    embedded = json.dumps(content, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
    style = "\n".join(
        (read_tokens(), alias_chart_colours(), (folder / "recognition-page.css").read_text("utf-8"))
    )
    script = (folder / "recognition-page.js").read_text("utf-8")
    answer = recognition.label or "not recognised"
    title = f"{view.title}: {ask_which(recognition.pair) if recognition.pair else answer}"
    return (
        "<!doctype html><html lang='en'><head><meta charset='utf-8'>"
        f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">'
        "<meta name='viewport' content='width=device-width, initial-scale=1'>"
        f"<title>{escape(title)}</title><style>{style}</style>"
        f"</head><body><main><header><h1>{escape(view.title)}</h1><p>{_subtitle(view, shown)}</p>"
        f"</header>{_why(explanation)}"
        "<section class='player' aria-label='The take'><canvas></canvas><div class='controls'>"
        "<button type='button'>Play</button>"
        "<input type='range' min='0' value='0' step='1' aria-label='Frame'>"
        f"<output></output></div></section><section>{charted}</section></main>"
        f"<script type='application/json' id='recording'>{embedded}</script>"
        f"<script type='module'>{script}</script></body></html>"
    )


def _subtitle(view: WorkspaceView, shown: Range) -> str:
    times = shown.poses.time
    language = f", language {escape(view.language.name)}" if view.language else ""
    return f"{times[0]:.2f} to {times[-1]:.2f} s of the clip{language}. Made with OSG Studio."


def _why(explanation: Explanation | None) -> str:
    if explanation is None:
        return ""
    found = explanation.counterfactuals
    helps = "".join(f"<li>{escape(each.change.words)}</li>" for each in found)
    listed = (
        f"<p class='dim'>It would have been read as {escape(explanation.expected)}:</p>"
        f"<ul>{helps}</ul>"
        if helps
        else ""
    )
    numbers = "".join(f"<li>{escape(line)}</li>" for line in explanation.details)
    return (
        f"<section class='why' aria-label='Why'><p>{escape(explanation.sentence)}</p>"
        f"<details><summary>Numbers</summary><ul>{numbers}</ul></details>{listed}</section>"
    )


def _recording(view: WorkspaceView, shown: Range) -> dict[str, Any]:
    """Return the data that the script plays: pictures, timestamps, poses, bones and trails."""
    poses = shown.poses
    stride = max(1, -(-len(poses) // MAX_PICTURES))
    kept = range(shown.first, shown.first + len(poses), stride)
    pictures = list(_pictures(view, kept))
    chosen = [index - shown.first for index in kept][: len(pictures)]
    names = {name: column for column, name in enumerate(poses.landmarks)}
    return {
        "frames": [url for url, _ in pictures],
        "size": pictures[0][1] if pictures else list(poses.frame_size),
        "times": [round(float(poses.time[index]), 3) for index in chosen],
        "poses": [pose_in(poses.xy[index], *poses.frame_size) for index in chosen],
        "bones": [[names[a], names[b]] for a, b in SKELETON if a in names and b in names],
        "trails": [names[name] for name in find_salient_motion(poses)[1]],
    }


def _pictures(view: WorkspaceView, kept: range) -> Iterator[tuple[str, list[int]]]:
    """Yield the frames of the clip as small JPEG data URLs with their size."""
    with read_frames(view.video) as frames:
        for frame in frames:
            if frame.index >= kept.stop:
                return
            if frame.index in kept:
                small = charts.shrink(frame.image, MAX_WIDTH)
                encoded = base64.b64encode(charts.encode_jpeg(small, JPEG_QUALITY)).decode("ascii")
                yield "data:image/jpeg;base64," + encoded, [small.shape[1], small.shape[0]]
