"""Node parameters: declared with description, default and allowed values."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.node import Node

Value = bool | int | float | str | list[str]

READ_AT_CONFIGURE = "read when the node is configured: clean it up and configure it again"


@dataclass(frozen=True)
class Setting:
    """One parameter.

    Attributes
    ----------
    name
        Name in a parameter file.
    default
        Default value, which also sets the type. An empty list of texts is ``[""]``, because an
        empty list has no type in ROS; empty texts in a list are ignored.
    description
        One sentence for `ros2 param describe`.
    least, most
        Range of a number.
    choices
        Allowed values of a text; empty for any.

    """

    name: str
    default: Value
    description: str
    least: float = 0.0
    most: float = 0.0
    choices: tuple[str, ...] = ()

    def descriptor(self) -> ParameterDescriptor:
        """Return the descriptor that `ros2 param describe` shows."""
        allowed = f"one of {', '.join(self.choices)}; " if self.choices else ""
        made = ParameterDescriptor(
            name=self.name,
            description=self.description,
            additional_constraints=allowed + READ_AT_CONFIGURE,
        )
        if self.most > self.least:
            if isinstance(self.default, float):
                made.floating_point_range = [
                    FloatingPointRange(from_value=self.least, to_value=self.most, step=0.0)
                ]
            else:
                made.integer_range = [
                    IntegerRange(from_value=int(self.least), to_value=int(self.most), step=1)
                ]
        return made


class Settings:
    """The declared parameters of a node.

    Parameters
    ----------
    node
        Node that gets the parameters.
    declared
        All parameters of the node.

    """

    def __init__(self, node: Node, declared: Iterable[Setting]) -> None:
        self._node = node
        self._declared = {setting.name: setting for setting in declared}
        for setting in self._declared.values():
            node.declare_parameter(setting.name, setting.default, setting.descriptor())

    def __getitem__(self, name: str) -> Any:
        """Return a parameter's current value.

        Raises
        ------
        ValueError
            When a text is not one of its choices.

        """
        setting, value = self._declared[name], self._node.get_parameter(name).value
        if isinstance(setting.default, list):
            return [text for text in value if text]
        if setting.choices and value not in setting.choices:
            known = ", ".join(setting.choices)
            raise ValueError(f"parameter {name} is {value!r}; set it to one of {known}")
        return value
