"""Setup script: what `ament_python` installs of the nodes."""

from pathlib import Path

from setuptools import find_packages, setup

PACKAGE = "osg_ros"
NODES = ("pose", "hand", "recognition", "visualisation", "command", "gesture")


def files(pattern: str) -> list[str]:
    """Return the files of a pattern, relative to this one."""
    return [str(path) for path in Path().glob(pattern)]


setup(
    name=PACKAGE,
    version="0.4.0",
    packages=find_packages(include=[PACKAGE, f"{PACKAGE}.*"]),
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{PACKAGE}"]),
        (f"share/{PACKAGE}", ["package.xml"]),
        (f"share/{PACKAGE}/launch", files("launch/*.launch.py")),
        (f"share/{PACKAGE}/config", files("config/*.yaml")),
    ],
    install_requires=["setuptools"],
    zip_safe=True,
    maintainer="OSG Studio maintainers",
    description="One-shot gesture recognition of divers as ROS 2 nodes",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            *(f"{node}_node = {PACKAGE}.nodes.{node}_node:main" for node in NODES),
            f"gesture_process = {PACKAGE}.nodes.gesture_process:main",
        ]
    },
)
