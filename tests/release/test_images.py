"""The robot's image, built and run where there is a builder and a base image.

``OSG_BASE_IMAGE`` names an image with Python that the builder has or may fetch, and
``OSG_BUILD_OPTIONS`` further options, such as volumes with certificates.
"""

from __future__ import annotations

import json
import os
import shlex
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from release.build import build_release
from release.checkout import ROOT

BASE = os.environ.get("OSG_BASE_IMAGE")
TAG = "localhost/osg-robot:tested"

MOST_MEGABYTES = 250
"""Size of what is installed, without the models."""

RUN = """
osg-studio samples /tmp/languages
cd /tmp/languages
osg-studio robot --language osg-table-2.json --source clips/line-test-1.mp4
"""

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        BASE is None or shutil.which("buildah") is None,
        reason="needs buildah, and OSG_BASE_IMAGE with an image that has Python",
    ),
]


def buildah(*arguments: str | Path, folder: Path = ROOT) -> str:
    finished = subprocess.run(
        ["buildah", *arguments], cwd=folder, capture_output=True, text=True, check=False
    )
    assert finished.returncode == 0, finished.stderr[-2000:]
    return finished.stdout.strip()


@pytest.fixture(scope="module")
def container(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Build the image from a release and give a container of it."""
    context = tmp_path_factory.mktemp("context")
    build_release(context / "dist")
    for name in (".dockerignore", *(lock.name for lock in ROOT.glob("requirements*.txt"))):
        shutil.copyfile(ROOT / name, context / name)
    recipe = ROOT / "release" / "containers" / "Containerfile"
    options = shlex.split(os.environ.get("OSG_BUILD_OPTIONS", ""))
    image = ("--file", recipe, "--target", "robot", "--tag", TAG, "--build-arg", f"BASE={BASE}")
    buildah("bud", "--format", "docker", *options, *image, ".", folder=context)
    made = buildah("from", TAG)
    yield made
    buildah("rm", made)
    buildah("rmi", TAG)


def test_the_robot_recognises_in_its_image_as_nobody(container: str) -> None:
    events = buildah("run", "--user", "10001", container, "--", "sh", "-ec", RUN).splitlines()
    labels = [json.loads(line).get("label") for line in events if "take_recognized" in line]
    assert labels == ["line"]
    assert buildah("run", container, "--", "id", "-u") == "10001"


def test_the_image_is_small_and_reads_every_kind_of_clip(container: str) -> None:
    packages = "du -sm --exclude=files /opt/osg | cut -f1"
    assert int(buildah("run", container, "--", "sh", "-c", packages)) <= MOST_MEGABYTES
    libraries = "import av, cv2, lz4.frame, rosbags, zstandard; print(cv2.__version__)"
    assert buildah("run", container, "--", "/opt/osg/bin/python3", "-c", libraries)


def test_the_image_speaks_mavlink_and_writes_nowhere_but_its_data(container: str) -> None:
    speak = "from app.robot.mavlink import talk; print(talk.build_heartbeat().get_type())"
    python = "/opt/osg/bin/python3"
    assert buildah("run", container, "--", python, "-c", speak) == "HEARTBEAT"
    written = "touch /data/a && ! touch /opt/osg/a 2>/dev/null && ! touch /etc/a 2>/dev/null"
    buildah("run", container, "--", "sh", "-c", written)
