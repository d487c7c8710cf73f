"""Our packages as a workspace that was built and sourced, for this process and for others."""

from __future__ import annotations

import fcntl
import hashlib
import os
import shutil
import sys
from importlib.util import find_spec
from pathlib import Path

from tests.ros2.compilers import find_compilers

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ROOT / "ros2"
OTHERS = Path(__file__).parent / "other_packages"
"""Message packages of others, not on PyPI, which the nodes use if installed."""

MESSAGE_PACKAGES = (
    PACKAGES / "osg_interfaces",
    PACKAGES / "keypoints_interfaces",
    OTHERS / "hri_msgs",
    OTHERS / "vision_msgs",
)
NODES = PACKAGES / "osg_ros"
CHECKED = {"ROS_PYTHON_CHECK_FIELDS": "1"}
"""Makes messages refuse values of another type; Humble's always do, newer ones only on request."""

KEPT = ROOT / ".pytest_cache" / "ros2"
"""What was built is kept until a definition changes."""


def missing() -> str | None:
    """Tell why there can be no workspace here; None: there can."""
    if find_spec("rclpy") is None:
        return "needs rclpy, of which there are wheels for Linux on x86-64 and Python up to 3.13"
    if find_compilers() is None:
        return "needs gcc, g++ and Python.h (python3-dev), to compile the message packages"
    return None


def source() -> None:
    """Build what is not built yet, and let this process import it, before any message."""
    os.environ.update(CHECKED)
    for place in paths():
        if str(place) not in sys.path:
            sys.path.insert(0, str(place))


def paths() -> tuple[Path, Path]:
    """Return the folders to import the message packages and the nodes from."""
    return _built(), NODES


def environment(domain: int) -> dict[str, str]:
    """Return the environment of a process in the workspace, alone with its DDS domain."""
    kept = os.environ.get("PYTHONPATH")
    places = [*map(str, paths()), str(ROOT), *([kept] if kept else [])]
    return {
        **os.environ,
        **CHECKED,
        "PYTHONPATH": os.pathsep.join(places),
        "ROS_DOMAIN_ID": str(domain),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "PYTHONUNBUFFERED": "1",
    }


def _built() -> Path:
    place = KEPT / _fingerprint()
    KEPT.mkdir(parents=True, exist_ok=True)
    # Two workers of one test run ask at the same time.
    with (KEPT / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not place.exists():
            # ROS 2's generators take long to import, and mostly all is built.
            from tests.ros2.typesupport import build

            for old in KEPT.glob("built-*"):
                shutil.rmtree(old)
            partial = KEPT / "partial"
            shutil.rmtree(partial, ignore_errors=True)
            for package in MESSAGE_PACKAGES:
                build(package, partial)
            partial.rename(place)
    return place


def _fingerprint() -> str:
    """Return a name that changes with the definitions, with how they are built, and for whom."""
    seen = hashlib.sha256(f"{sys.version} {sys.prefix}".encode())
    builder = Path(__file__).with_name("typesupport.py")
    definitions = (each for package in MESSAGE_PACKAGES for each in package.glob("*/*.*"))
    for file in (builder, *sorted(definitions)):
        seen.update(file.name.encode() + file.read_bytes())
    return f"built-{seen.hexdigest()[:16]}"
