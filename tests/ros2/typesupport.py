"""Builds message packages for real rclpy, with ROS 2's own generators and the machine's compiler.

On a robot `colcon build` does this. The generators are on PyPI, ament_cmake is not; so what its
CMake files would do is done here: translate to IDL, generate C and Python, compile one extension.
"""

from __future__ import annotations

import io
import subprocess
import sys
import sysconfig
from collections.abc import Sequence
from contextlib import redirect_stdout
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import rosidl_generator_c
import rosidl_generator_py
import rosidl_typesupport_c
import rosidl_typesupport_fastrtps_c
from rosidl_adapter.msg import convert_msg_to_idl
from rosidl_adapter.srv import convert_srv_to_idl
from rosidl_cli.command.helpers import (
    generate_visibility_control_file,
    generator_arguments_file,
    legacy_generator_arguments,
    ros_interface_file_from_idl,
)
from rosidl_generator_type_description import generate_type_hash

from tests.ros2.compilers import PYTHON_HEADERS, find_compilers

PREFIX = Path(sys.prefix)
"""Where pip put ROS 2: headers in include, libraries in lib, definitions in share."""

SHARE = PREFIX / "share"

DEPENDENCIES = ("builtin_interfaces", "service_msgs", "std_msgs")
"""Message packages that ours use; the events of a service use the second."""

KINDS = ("generator_c", "generator_py", "typesupport_c", "typesupport_fastrtps_c")
"""Libraries of a message package that are linked by messages which contain its messages."""

LIBRARIES = (
    "fastcdr",
    "rcutils",
    "rmw",
    "rosidl_runtime_c",
    "rosidl_typesupport_c",
    "rosidl_typesupport_fastrtps_c",
    "rosidl_typesupport_fastrtps_cpp",
)


def build(package: Path, into: Path) -> None:
    """Build a message package so that Python can import it from `into`.

    Parameters
    ----------
    package
        Folder with msg/ and maybe srv/; its name is the package's.
    into
        Folder that gets a package of that name.

    """
    made = into / package.name
    made.mkdir(parents=True)
    (made / "__init__.py").touch()
    with redirect_stdout(io.StringIO()):  # every generator names every file
        generate(package, made)
    compile_extension(package.name, made)


def generate(package: Path, made: Path) -> None:
    """Generate the C and Python sources of a message package into the folder `made`."""
    definitions = [*sorted(package.glob("msg/*.msg")), *sorted(package.glob("srv/*.srv"))]
    for definition in definitions:
        convert = convert_msg_to_idl if definition.suffix == ".msg" else convert_srv_to_idl
        convert(
            package, package.name, definition.relative_to(package), made / definition.parent.name
        )
    files = [f"{made}:{each.parent.name}/{each.stem}.idl" for each in definitions]
    arguments = partial(_arguments, package.name, files, made)
    with generator_arguments_file(
        **arguments("rosidl_generator_type_description"),
        include_paths=[f"{name}:{SHARE / name}" for name in DEPENDENCIES],
    ) as path:
        described = {Path(hashed).stem: hashed for hashed in generate_type_hash(path)}
    with generator_arguments_file(
        **arguments("rosidl_generator_c"),
        type_description_tuples=[
            f"{each.parent.name}/{each.stem}.idl:{described[each.stem]}" for each in definitions
        ],
        ros_interface_files=[str(ros_interface_file_from_idl(each)) for each in files],
    ) as path:
        rosidl_generator_c.generate_c(path)
    with generator_arguments_file(**arguments("rosidl_typesupport_fastrtps_c")) as path:
        rosidl_typesupport_fastrtps_c.generate_typesupport_fastrtps_c(path)
    with generator_arguments_file(**arguments("rosidl_typesupport_c")) as path:
        rosidl_typesupport_c.generate_c(path, ["rosidl_typesupport_fastrtps_c"])
    with generator_arguments_file(**arguments("rosidl_generator_py")) as path:
        rosidl_generator_py.generate_py(path, ["rosidl_typesupport_c"])
    for generator in ("rosidl_generator_c", "rosidl_typesupport_fastrtps_c"):
        header = f"{generator}__visibility_control.h"
        generate_visibility_control_file(
            package_name=package.name,
            template_path=SHARE / generator / "resource" / f"{header}.in",
            output_path=made / "msg" / header,
        )


def _arguments(package: str, files: Sequence[str], made: Path, generator: str) -> dict[str, Any]:
    """Return the arguments that every generator gets."""
    arguments: dict[str, Any] = legacy_generator_arguments(
        package_name=package,
        interface_files=list(files),
        include_paths=[str(SHARE / name) for name in DEPENDENCIES],
        templates_path=SHARE / generator / "resource",
        output_path=made,
    )
    return arguments


def compile_extension(name: str, made: Path) -> None:
    """Compile all generated sources of a package into its one Python extension.

    Most sources are compiled as one, which takes a tenth of the time; only the descriptions use the
    same names for different things.
    """
    found = find_compilers()
    assert found is not None
    c, cpp = found
    includes = [
        made.parent,
        PREFIX / "include",
        *(each for each in (PREFIX / "include").iterdir() if each.is_dir()),
        PYTHON_HEADERS,
        Path(np.get_include()),
    ]
    flags = ["-w", "-O0", "-fPIC", *(f"-I{each}" for each in includes)]
    descriptions = sorted(made.rglob("*__description.c"))
    all_c = _as_one(sorted(set(made.rglob("*.c")) - set(descriptions)), made / "all.c")
    all_cpp = _as_one(sorted(made.rglob("*.cpp")), made / "all.cpp")
    _run([c, *flags, "-c", all_c, *descriptions], made)
    _run([cpp, *flags, "-std=c++17", "-c", all_cpp, "-o", "all_cpp.o"], made)
    present = {path.name for path in (PREFIX / "lib").glob("lib*.so")}
    used = [f"{each}__rosidl_{kind}" for each in DEPENDENCIES for kind in KINDS]
    linked = [each for each in (*used, *LIBRARIES) if f"lib{each}.so" in present]
    extension = f"{name}_s__rosidl_typesupport_c{sysconfig.get_config_var('EXT_SUFFIX')}"
    libraries = [f"-L{PREFIX / 'lib'}", f"-Wl,-rpath,{PREFIX / 'lib'}"]
    objects = sorted(made.glob("*.o"))
    _run([cpp, "-shared", "-o", extension, *objects, *libraries, *(f"-l{x}" for x in linked)], made)


def _as_one(sources: Sequence[Path], one: Path) -> Path:
    one.write_text("".join(f'#include "{source}"\n' for source in sources), encoding="utf-8")
    return one


def _run(command: Sequence[str | Path], folder: Path) -> None:
    subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True)
