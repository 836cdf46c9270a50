"""The type stub has every public name of the module with its parameters, and no other."""

import ast
import inspect
import pathlib
import re

import numpy as np
import pytest
import stillkite

PACKAGE = pathlib.Path(stillkite.__file__).parent
STUB = ast.parse((PACKAGE / "__init__.pyi").read_text())
DEFINITIONS = {node.name: node for node in STUB.body
               if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
CLASSES = [name for name, node in DEFINITIONS.items() if isinstance(node, ast.ClassDef)]
OPERATORS = {"__init__", "__len__", "__matmul__"}


def members(node):
    return {entry.name: entry for entry in node.body if isinstance(entry, ast.FunctionDef)}


def stub_parameters(function):
    """Names in order; * before those by keyword alone."""
    arguments = function.args
    names = [a.arg for a in arguments.posonlyargs + arguments.args]
    by_keyword = [a.arg for a in arguments.kwonlyargs]
    return [n for n in names + (["*"] if by_keyword else []) + by_keyword if n != "self"]


def stub_required(function):
    arguments = function.args
    names = [a.arg for a in arguments.args]
    required = names[:len(names) - len(arguments.defaults)]
    return [n for n in required if n != "self"]


def signature(function):
    """Parameters of the first line of pybind11's docstring: (name, has default)."""
    text = re.match(r"\w+\((.*)\) -> ", function.__doc__).group(1)
    depth, parts = 0, [""]
    for character in text:
        depth += (character in "[(<") - (character in "])>")
        if character == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += character
    parts = [part.strip() for part in parts if part.strip()]
    return [(re.split(r"[:=]", part)[0].strip(), " = " in part)
            for part in parts if not part.startswith("self:")]


def check_signature(function, stub):
    actual = signature(function)
    assert [name for name, _ in actual] == stub_parameters(stub), stub.name
    before_keywords = [name for name, _ in actual].index("*") if ("*", False) in actual else None
    positional = actual[:before_keywords]
    assert [n for n, default in positional if not default] == stub_required(stub), stub.name


def test_the_stub_has_every_public_name():
    assert (PACKAGE / "py.typed").exists()
    assert set(stillkite.__all__) == set(DEFINITIONS)
    assert stillkite.__version__


@pytest.mark.parametrize("name", CLASSES)
def test_the_stub_of_a_class_has_every_member(name):
    actual = getattr(stillkite, name)
    if issubclass(actual, Exception):
        return
    stub = members(DEFINITIONS[name])
    public = {n for n in vars(actual) if not n.startswith("_") or n in OPERATORS}
    # a class without a constructor has pybind11's, which raises
    if "__init__" not in stub:
        with pytest.raises(TypeError, match="No constructor defined"):
            actual()
        public.discard("__init__")
    assert public == set(stub)
    for member, entry in stub.items():
        is_property = any(getattr(d, "id", "") == "property" for d in entry.decorator_list)
        value = inspect.getattr_static(actual, member)
        assert isinstance(value, property) == is_property, member
        if not is_property and member not in ("__len__", "__matmul__"):
            check_signature(getattr(actual, member), entry)


@pytest.mark.parametrize("name", sorted(set(DEFINITIONS) - set(CLASSES)))
def test_the_stub_of_a_function_has_its_parameters(name):
    check_signature(getattr(stillkite, name), DEFINITIONS[name])


def test_every_public_name_has_a_docstring():
    for name in stillkite.__all__:
        actual = getattr(stillkite, name)
        assert actual.__doc__, name
        for member in vars(actual) if isinstance(actual, type) else ():
            if not member.startswith("_"):
                assert inspect.getattr_static(actual, member).__doc__, f"{name}.{member}"


def test_literals_of_the_stub_are_the_names_that_the_library_knows():
    literals = {node.targets[0].id: [element.value for element in ast.walk(node.value)
                                     if isinstance(element, ast.Constant)]
                for node in STUB.body if isinstance(node, ast.Assign)
                and isinstance(node.value, ast.Subscript)
                and getattr(node.value.value, "id", "") == "Literal"}

    def known(make):
        with pytest.raises(stillkite.InputError, match="is not one of: ") as raised:
            make()
        return str(raised.value).split("is not one of: ")[1].split(", ")

    q = [1, 0, 0, 0]
    trajectory = stillkite.Trajectory(np.array([0]), [[0, 0, 0]])
    decide = stillkite.HoldController().decide
    motion = stillkite.MotionEstimate
    camera = stillkite.Camera
    assert literals["_Alignment"] == known(lambda: stillkite.evaluate(trajectory, trajectory, "?"))
    assert literals["_Displacement"] == known(lambda: motion(0, q, displacement_kind="?"))
    assert literals["_Status"] == known(lambda: motion(0, q, status="?"))
    assert literals["_Scale"] == known(lambda: motion(0, q, scale="?"))
    assert literals["_HoldReason"] == known(lambda: decide(0, None, None, q, "?"))
    assert literals["_Distortion"] == known(lambda: camera(1, 1, 1, 1, 0, 0, "?"))
