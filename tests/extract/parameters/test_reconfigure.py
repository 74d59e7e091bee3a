from __future__ import annotations

from typing import TYPE_CHECKING

from extract.workspaces import codes, manifest, reader_of

from kg.extract.parameters import read_configuration

if TYPE_CHECKING:
    from pathlib import Path

    from kg.corpus.reading import Reader
    from kg.facts import Parameter

HEAD = (
    "#!/usr/bin/env python\nfrom dynamic_reconfigure.parameter_generator_catkin import *\ngen = ParameterGenerator()\n"
)


def read(root: Path, text: str, others: dict[str, str | bytes] | None = None) -> tuple[tuple[Parameter, ...], Reader]:
    """Return the content of `cfg/Demo.cfg` with this text, and its reader."""
    reader = reader_of(root, {"cfg/Demo.cfg": HEAD + text, **(others or {})})
    return read_configuration(reader, reader.file("demo/cfg/Demo.cfg")), reader


def test_parameters_of_a_generator_and_its_groups(tmp_path: Path) -> None:
    """`add` of a generator or a group is a parameter with type, default, description and line; enums are not."""
    text = (
        'PACKAGE = "demo"\nsub = gen.add_group("sub")\n'
        'gen.add("rate", double_t, 0, "How " "often", 1.5, 0, 9)\n'
        'sub.add("on", bool_t, 0, "Whether", False)\nsub.add(name="mode", paramtype=str_t, default="a")\n'
        'e = gen.enum([gen.const("one", int_t, 1, "")], "")\nnames.add("x")\n'
        'exit(gen.generate(PACKAGE, "demo", "Demo"))\n'
    )
    found, _ = read(tmp_path, text)
    assert [(p.name, p.type, p.default, p.description, p.location.line) for p in found] == [
        ("rate", "double", "1.5", "How often", 6),
        ("on", "bool", "false", "Whether", 7),
        ("mode", "string", '"a"', None, 8),
    ]


def test_names_and_defaults_are_computed(tmp_path: Path) -> None:
    """A loop adds a parameter in each iteration; an unknown part is a hole in a name; an unknown default is none."""
    text = (
        'for i in range(2):\n    gen.add("topic_%d" % i, str_t)\n'
        'gen.add("pre" + x, int_t, 0, "", -3)\ngen.add("turn", double_t, 0, "", 1 / 2.0)\n'
        'gen.add("late", double_t, 0, "", x)\n'
    )
    found, _ = read(tmp_path, text)
    assert [(p.name, p.default) for p in found] == [
        ("topic_0", None),
        ("topic_1", None),
        ("pre{}", "-3"),
        ("turn", "0.5"),
        ("late", None),
    ]


def test_a_function_of_another_package_adds_its_parameters(tmp_path: Path) -> None:
    """Parameters added by an imported function have the place in that function."""
    other = (
        "from dynamic_reconfigure.parameter_generator_catkin import *\n"
        'def add_limits(gen):\n    gen.add("max_vel", double_t, 0, "")\n\ndef other(gen):\n    gen.add("no", int_t)\n'
    )
    files: dict[str, str | bytes] = {
        "../limits/package.xml": manifest("limits"),
        "../limits/src/limits/__init__.py": other,
    }
    found, _ = read(tmp_path, 'from limits import add_limits\nadd_limits(gen)\ngen.add("own", int_t)\n', files)
    assert [(p.name, str(p.location)) for p in found] == [
        ("max_vel", "limits/src/limits/__init__.py:3"),
        ("own", "demo/cfg/Demo.cfg:6"),
    ]


def test_a_part_that_does_not_parse_is_reported(tmp_path: Path) -> None:
    """The parameters around a syntax error are read, and the error has its line."""
    found, reader = read(tmp_path, 'gen.add("a", int_t)\n)) = ((\ngen.add("b", int_t)\n')
    assert {p.name for p in found} == {"a", "b"}
    assert codes(reader.problems) == [("KG115", 5)]
