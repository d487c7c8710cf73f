"""A robot without ROS 2 that says the same again and again; the process of its own in a test.

``python -m tests.robot.publishing_robot``
"""

from __future__ import annotations

import time
from contextlib import closing

from app.robot import Listener
from app.robot.publishing import open_publisher
from app.robot.runtime import language_changed
from tests.api.recordings import recording_of
from tests.robot.languages import heard, spoken

PAUSE = 0.2
"""Seconds between two rounds: whoever listens may join at any time."""


def main() -> None:
    """Publish until the process is ended."""
    language = spoken("circle")
    shown = recording_of("circle", "line")
    told = [language_changed(0.0, language), *heard(Listener(language), shown)]
    with closing(open_publisher("dds")) as publisher:
        while True:
            for event in told:
                publisher.publish(event)
            time.sleep(PAUSE)


if __name__ == "__main__":
    main()
