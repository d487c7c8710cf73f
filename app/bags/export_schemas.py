"""JSON Schemas of the messages in an exported bag.

Foxglove knows its own messages by their names (https://docs.foxglove.dev/docs/sdk/schemas); their
schemas here contain only the fields that are written. The other messages are ours. All schemas are
complete, without references or alternatives, because readers of MCAP understand only these.
"""

from __future__ import annotations

from typing import Any

Schema = dict[str, Any]

TEXT: Schema = {"type": "string"}
NUMBER: Schema = {"type": "number"}
FLAG: Schema = {"type": "boolean"}
BYTES: Schema = {"type": "string", "contentEncoding": "base64"}


def describe(schema: Schema, description: str) -> Schema:
    """Return `schema` with a description."""
    return {**schema, "description": description}


def record(title: str, **fields: Schema) -> Schema:
    """Return the schema of an object with these fields, all of them required."""
    return {
        "title": title,
        "type": "object",
        "properties": fields,
        "required": list(fields),
    }


def many(items: Schema) -> Schema:
    """Return the schema of an array."""
    return {"type": "array", "items": items}


def one_of(**values: int) -> Schema:
    """Return the schema of a named number."""
    return {"oneOf": [{"title": name, "const": value} for name, value in values.items()]}


TIME = record(
    "time",
    sec={"type": "integer", "minimum": 0},
    nsec={"type": "integer", "minimum": 0, "maximum": 999_999_999},
)
COLOUR = record("foxglove.Color", r=NUMBER, g=NUMBER, b=NUMBER, a=NUMBER)
POINT = record("foxglove.Point2", x=NUMBER, y=NUMBER)
PAIRS = many(record("foxglove.KeyValuePair", key=TEXT, value=TEXT))

VIDEO = record("foxglove.CompressedVideo", timestamp=TIME, frame_id=TEXT, data=BYTES, format=TEXT)


def list_annotations(title: str, **fields: Schema) -> Schema:
    """Return the schema of a list of annotations, each with its time and further facts."""
    return many(record(title, timestamp=TIME, **fields, metadata=PAIRS))


ANNOTATIONS = record(
    "foxglove.ImageAnnotations",
    circles=list_annotations(
        "foxglove.CircleAnnotation",
        position=POINT,
        diameter=NUMBER,
        thickness=NUMBER,
        fill_color=COLOUR,
        outline_color=COLOUR,
    ),
    points=list_annotations(
        "foxglove.PointsAnnotation",
        type=one_of(UNKNOWN=0, POINTS=1, LINE_LOOP=2, LINE_STRIP=3, LINE_LIST=4),
        points=many(POINT),
        outline_color=COLOUR,
        outline_colors=many(COLOUR),
        fill_color=COLOUR,
        thickness=NUMBER,
    ),
    texts=list_annotations(
        "foxglove.TextAnnotation",
        position=POINT,
        text=TEXT,
        font_size=NUMBER,
        text_color=COLOUR,
        background_color=COLOUR,
    ),
)
LOG = record(
    "foxglove.Log",
    timestamp=TIME,
    level=one_of(UNKNOWN=0, DEBUG=1, INFO=2, WARNING=3, ERROR=4, FATAL=5),
    message=TEXT,
    name=TEXT,
    file=TEXT,
    line={"type": "integer", "minimum": 0},
)

KEYPOINTS = record(
    "osg_studio.Keypoints",
    timestamp=TIME,
    image_width=describe(NUMBER, "Pixels"),
    image_height=describe(NUMBER, "Pixels"),
    body=describe(
        many(
            record(
                "osg_studio.Keypoint",
                name=describe(TEXT, "MediaPipe's, in snake_case"),
                x=describe(NUMBER, "Pixels to the right of the picture's left edge"),
                y=describe(NUMBER, "Pixels below the picture's top edge"),
                confidence=describe(NUMBER, "0 to 1; 1 where the source gives none"),
            )
        ),
        "Landmarks seen; empty where nobody is",
    ),
    hands=many(
        record(
            "osg_studio.Hand",
            side=describe(TEXT, "The person's own: left or right"),
            score=describe(NUMBER, "0 to 1, the belief that there is a hand at all"),
            keypoints=describe(many(POINT), "Pixels, MediaPipe's 21 in their order"),
        )
    ),
)

SALUTE = record(
    "osg_studio.Salute",
    timestamp=TIME,
    score=describe(NUMBER, "0 to 1, how much the best hand salutes"),
    held=describe(FLAG, "Whether the salute counts now"),
    state=describe(TEXT, "Of the recogniser: idle, recording, done"),
)

TAKE = record(
    "osg_studio.Take",
    start=describe(NUMBER, "Seconds: the start salute is released"),
    end=describe(NUMBER, "Seconds: the stop salute begins"),
    closed=describe(FLAG, "Whether a stop salute ended it"),
    stroke_start=describe(NUMBER, "Seconds: the gesture itself begins"),
    stroke_end=describe(NUMBER, "Seconds: the gesture itself ends"),
)

RECOGNITION = record(
    "osg_studio.Recognition",
    start=describe(NUMBER, "Seconds: what was recognised begins"),
    end=describe(NUMBER, "Seconds: what was recognised ends"),
    language=TEXT,
    revision={"type": "integer", "minimum": 0},
    profile=describe(TEXT, "Of the recogniser: full or paper"),
    label=describe(TEXT, "The gesture; empty for a pair and when rejected"),
    pair=describe(many(TEXT), "The two gestures between which the take lies; else empty"),
    nearest=describe(TEXT, "The best gesture, also when rejected"),
    rejected=FLAG,
    reason=describe(TEXT, "Why the take is too poor to judge; else empty"),
    confidence=describe(NUMBER, "0 to 1"),
    expected=describe(TEXT, "The gesture meant, where it is known; else empty"),
    votes=many(record("osg_studio.Vote", voter=TEXT, label=TEXT, weight=NUMBER)),
    distances=describe(
        many(record("osg_studio.Distance", voter=TEXT, gesture=TEXT, distance=NUMBER)),
        "Smaller is more alike, each voter in its own unit; without those not comparable",
    ),
)
