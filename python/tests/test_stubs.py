# SPDX-License-Identifier: LGPL-2.1-or-later
"""The type stubs name exactly what the module has: names, properties and arguments."""
import ast
import inspect
import pathlib
import re

import pytest

import hexaplast

STUBS = ast.parse((pathlib.Path(hexaplast.__file__).parent / "__init__.pyi").read_text())
FUNCTIONS = {node.name: node for node in STUBS.body if isinstance(node, ast.FunctionDef)}
CLASSES = {node.name: node for node in STUBS.body if isinstance(node, ast.ClassDef)}
PLAIN = {node.target.id for node in STUBS.body if isinstance(node, ast.AnnAssign)}


def arguments_of_stub(function):
    return [argument.arg for argument in function.args.args + function.args.kwonlyargs if argument.arg != "self"]


def arguments_of(function):
    """Of C++, from the signature in the first line of the documentation, which is made from the code."""
    if inspect.isfunction(function):
        return [name for name in inspect.signature(function).parameters if name != "self"]
    inside = re.match(r"\w+\((.*)\) -> ", inspect.getdoc(function)).group(1)
    return [name for name in re.findall(r"(?:^|, )(\w+): ", inside) if name != "self"]


def members_of_stub(node):
    methods = {entry.name: entry for entry in node.body if isinstance(entry, ast.FunctionDef)}
    properties = {name for name, entry in methods.items() if entry.decorator_list}
    properties |= {entry.target.id for entry in node.body if isinstance(entry, ast.AnnAssign)}
    return properties, {name: entry for name, entry in methods.items() if name not in properties}


def test_every_public_name_is_in_the_stubs():
    public = set(hexaplast.__all__)
    names = {name for name in dir(hexaplast) if not inspect.ismodule(getattr(hexaplast, name))}  # but for hexaplast.study
    assert public == {name for name in names if not name.startswith("_")} | {"__version__"}
    assert public == set(FUNCTIONS) | set(CLASSES) | PLAIN - {"__all__"}


@pytest.mark.parametrize("name", sorted(CLASSES))
def test_members_of_a_class_are_those_of_its_stub(name):
    cls = getattr(hexaplast, name)
    properties, methods = members_of_stub(CLASSES[name])
    public = {member: value for member, value in vars(cls).items() if not member.startswith("_")}
    assert {member for member, value in public.items() if isinstance(value, property)} == properties
    assert {member for member, value in public.items() if not isinstance(value, property)} == {
        method for method in methods if not method.startswith("_")
    }
    assert [base.id for base in CLASSES[name].bases] == [
        base.__name__ for base in cls.__bases__ if base.__name__ not in ("pybind11_object", "object")
    ]
    for method, stub in methods.items():
        assert arguments_of(getattr(cls, method)) == arguments_of_stub(stub), method


@pytest.mark.parametrize("name", sorted(FUNCTIONS))
def test_arguments_of_a_function_are_those_of_its_stub(name):
    assert arguments_of(getattr(hexaplast, name)) == arguments_of_stub(FUNCTIONS[name])


def test_everything_public_is_documented():
    for name in CLASSES:
        assert len(inspect.getdoc(getattr(hexaplast, name))) > 20, name
