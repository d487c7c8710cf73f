"""ONNX model: conversion of a whole TensorFlow Lite model."""

from __future__ import annotations

from collections.abc import Collection
from types import ModuleType
from typing import Final

import onnx
from onnx import NodeProto, TensorProto, ValueInfoProto, helper

from release.models.graph import GraphBuilder
from release.models.operators import convert_operator
from release.models.tflite import TfliteModel, read_tflite

OPERATOR_SET: Final = 13
"""The oldest ONNX operator set with all that is needed: any ONNX Runtime since 1.8 runs it,
also those that ship with a robot's older CUDA."""

FILE_VERSION: Final = 8
"""ONNX file format version that the same runtimes support."""


def to_onnx(tflite: bytes, schema: ModuleType, credit: str, unused: Collection[str] = ()) -> bytes:
    """Convert a TensorFlow Lite model.

    Inputs and outputs keep their names, shapes and order, images as batch, height, width,
    channels. No number is computed, only rearranged: results differ from TensorFlow Lite's by
    the rounding of another runtime.

    Parameters
    ----------
    tflite
        The bytes of the ``.tflite`` file.
    schema
        The generated module of TensorFlow Lite's model schema.
    credit
        Origin and licence, kept in the model's description.
    unused
        Names of outputs to leave out, with the nodes that only they need: ONNX Runtime computes
        every output of a file, even if it is not requested.

    Returns
    -------
    The bytes of the ``.onnx`` file; always the same for the same input.

    Raises
    ------
    ModelError
        When the content is no TensorFlow Lite model or uses an operator not known here.

    """
    model = read_tflite(tflite, schema)
    graph = GraphBuilder(model)
    for index in model.inputs:
        graph.set_value(index, model.tensors[index].name, "stored")
    for operator in model.operators:
        convert_operator(graph, operator)
    outputs = tuple(i for i in model.outputs if model.tensors[i].name not in unused)
    for index in outputs:
        name = model.tensors[index].name
        graph.nodes.append(
            helper.make_node("Identity", [graph.value(index, "stored")], [name], name=name)
        )
    nodes = _select_needed(graph.nodes, {model.tensors[index].name for index in outputs})
    read = {name for node in nodes for name in node.input}
    converted = helper.make_model(
        helper.make_graph(
            nodes,
            "mediapipe",
            _describe_values(model, model.inputs),
            _describe_values(model, outputs),
            [weight for weight in graph.weights if weight.name in read],
        ),
        opset_imports=[helper.make_opsetid("", OPERATOR_SET)],
        ir_version=FILE_VERSION,
        producer_name="osg-studio",
        doc_string=credit,
    )
    onnx.checker.check_model(converted)
    content: bytes = converted.SerializeToString(deterministic=True)
    return content


def _select_needed(nodes: list[NodeProto], wanted: set[str]) -> list[NodeProto]:
    """Return the nodes, in the order of computation, that any wanted value needs."""
    needed = []
    wanted = set(wanted)
    for node in reversed(nodes):
        if wanted.intersection(node.output):
            needed.append(node)
            wanted.update(node.input)
    return needed[::-1]


def _describe_values(model: TfliteModel, indices: tuple[int, ...]) -> list[ValueInfoProto]:
    return [
        helper.make_tensor_value_info(
            model.tensors[index].name, TensorProto.FLOAT, model.tensors[index].shape
        )
        for index in indices
    ]
