"""One model of options: declared once, the same in Python, on the command line and in the docs."""

from __future__ import annotations

import re
import sys
from collections import defaultdict
from inspect import signature
from pathlib import Path
from types import NoneType
from typing import Literal, get_args, get_origin

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

import roundelay as rl
from roundelay.base.options import choices, leaves
from roundelay.cli import app
from roundelay.commands.listing import filled
from roundelay.commands.options import taken_by
from roundelay.cycles.edit import blend
from roundelay.cycles.edit.options import BlendOptions, TransitionOptions
from roundelay.formats import suffixes_of, writers
from roundelay.segmentation import GaussianOptions, PCAOptions, PPCAOptions, segment_channels

ROOT = Path(__file__).parent.parent
sys.path.insert(0, str(ROOT / "docs"))
import tables  # noqa: E402

COMMANDS = typer.main.get_command(app).commands
DECLARED = [(kind, one) for kind in tables.option_classes() for one in tables.declared(kind)]
SINGLE = [(kind, one) for kind, one in DECLARED if one.options is None]
ON_COMMANDS = [
    (name, one)
    for name, command in tables.commands().items()
    for taken in taken_by(command)
    for one in taken
]


def named(pair):
    where = pair[0] if isinstance(pair[0], str) else pair[0].__name__
    return f"{where}.{pair[1].name}"


def parameter(command, one):
    (found,) = [p for p in COMMANDS[command].params if f"--{one.flag}" in p.opts]
    return found


def beyond(known):
    """Numbers just outside the range."""
    edges = [(known.least, -1), (known.most, 1), (known.above, 0), (known.below, 0)]
    return [edge + step for edge, step in edges if edge is not None]


def within(one, number):
    """A value of the option's type that holds a number."""
    shapes = [get_args(kind) for kind in choices(one.kind) if get_origin(kind) is tuple]
    return (number,) * len(shapes[0]) if shapes else number


def written(value):
    """A number or a pair as on the command line."""
    return ":".join(map(str, value)) if isinstance(value, tuple) else str(value)


def test_all_options_are_walked():
    names = {kind.__name__ for kind in tables.option_classes()}
    assert {"Options", "TopologyOptions", "LoopOptions", "GaussianOptions", "GMMOptions"} <= names
    assert len(ON_COMMANDS) > 80


@pytest.mark.parametrize("pair", ON_COMMANDS, ids=named)
def test_the_command_line_says_what_is_declared(pair):
    command, one = pair
    found = parameter(command, one)
    assert found.default == one.default
    for told in (one.known.text.rstrip("."), one.known.unit, one.known.range):
        assert told in found.help
    for kind in choices(one.kind):
        if get_origin(kind) is Literal:
            assert found.metavar.split("|") == list(get_args(kind))


@pytest.mark.parametrize("pair", ON_COMMANDS, ids=named)
def test_the_command_line_refuses_what_the_dataclass_refuses(pair):
    command, one = pair
    for number in beyond(one.known):
        asked = f"--{one.flag}={written(within(one, number))}"
        result = CliRunner().invoke(app, [command, asked])
        assert result.exit_code == 2
        assert re.search(f"'--{one.flag}': expected {one.flag} as .*, found", result.stderr)


@pytest.mark.parametrize("pair", SINGLE, ids=named)
def test_values_out_of_range_are_refused(pair):
    kind, one = pair
    for number in beyond(one.known):
        with pytest.raises(ValueError, match=rf"^expected {one.name} as .*, found \(?{number}"):
            kind(**{one.name: within(one, number)})


@pytest.mark.parametrize("pair", DECLARED, ids=named)
def test_values_of_a_wrong_type_are_refused(pair):
    kind, one = pair
    wrong = [object(), "no such name"]
    if str in choices(one.kind):
        wrong.pop()
    if NoneType not in choices(one.kind):
        wrong.append(None)
    for value in wrong:
        with pytest.raises(ValueError, match=f"^expected {one.name} as .*, found"):
            kind(**{one.name: value})


@pytest.mark.parametrize("kind", tables.option_classes(), ids=lambda kind: kind.__name__)
def test_unknown_names_are_refused(kind):
    with pytest.raises(TypeError, match="tempo"):
        kind(tempo=3)


def test_tables_list_what_is_registered():
    text = tables.tables()
    known = ", ".join(suffix[1:] for suffix in suffixes_of(writers))
    assert f"Format of the file: {known}." in text
    assert "{" not in text


@pytest.mark.parametrize("name", ["joints", "proposers"])
def test_an_empty_choice_is_refused(name):
    with pytest.raises(ValueError, match=f"expected {name} as at least one name, or None"):
        rl.Options(**{name: ()})


@pytest.mark.parametrize("value", [float("nan"), float("inf"), True, "2"])
def test_what_is_no_number_is_refused(value):
    with pytest.raises(ValueError, match="expected scale as a number, more than 0, in body sizes"):
        rl.TopologyOptions(scale=value)


def test_numbers_of_numpy_and_lists_are_taken():
    options = rl.Options(
        frames=np.array([3, 90]),
        joints=["Hips", "Spine"],
        most=np.int64(2),
        velocity=np.bool_(True),
        topology=rl.TopologyOptions(delay=np.float32(0.5), dimensions=np.int8(3)),
    )
    topology = rl.TopologyOptions(delay=0.5, dimensions=3)
    plain = rl.Options((3, 90), ("Hips", "Spine"), most=2, topology=topology)
    assert options == plain
    assert hash(options) == hash(plain)
    assert type(options.most) is int
    assert type(options.velocity) is bool


@pytest.mark.parametrize(
    ("kind", "values"),
    [
        (PCAOptions, {"lag": 2.0}),
        (PCAOptions, {"start": 1.0}),
        (PPCAOptions, {"step": 2.0}),
        (rl.Options, {"velocity": False}),
        (rl.TopologyOptions, {"dimensions": 2.5}),
    ],
)
def test_options_that_do_not_go_together_are_refused(kind, values):
    with pytest.raises(ValueError, match="found"):
        kind(**values)


def test_frames_may_end_with_the_take():
    assert rl.Options(frames=(10, None)).span(90) == (10, 90)
    assert rl.Options(frames=(10, 20)).span(90) == (10, 20)
    assert rl.Options().span(90) is None
    for frames in ((20, 10), (0, 91), (90, None)):
        with pytest.raises(ValueError, match="expected frames within 0 and 90, found"):
            rl.Options(frames=frames).span(90)


def test_a_name_has_one_meaning():
    """A file or a folder to write is -o everywhere."""
    meanings = defaultdict(set)
    for command in COMMANDS.values():
        for found in command.params:
            for name in {*found.opts, *found.secondary_opts} - {"-o"}:
                if name.startswith("-"):
                    meanings[name].add(found.help)
    several = {name: told for name, told in meanings.items() if len(told) > 1}
    # What a library is made into is no file.
    assert set(several) <= {"--output"}
    declared = defaultdict(set)
    for _, one in ON_COMMANDS:
        declared[one.flag].add(id(one.known))
    assert {flag for flag, known in declared.items() if len(known) > 1} == set()


def test_a_command_takes_no_name_twice():
    for command in COMMANDS.values():
        names = [name for found in command.params for name in found.opts + found.secondary_opts]
        assert len(names) == len(set(names))


@pytest.mark.parametrize(
    ("function", "options"),
    [
        (rl.Cycle.sample, rl.LoopOptions),
        (rl.segment, GaussianOptions),
        (segment_channels, GaussianOptions),
        (rl.transition, TransitionOptions),
        (blend.blend, BlendOptions),
        (rl.excitations, rl.Options),
    ],
)
def test_functions_have_the_defaults_that_are_declared(function, options):
    made, given = options(), {one.name: one.default for one in leaves(options)}
    shared = signature(function).parameters.keys() & given.keys()
    assert shared
    for name in shared:
        # What is None may be chosen when the options are made.
        default = getattr(made, name, None) if given[name] is None else given[name]
        assert signature(function).parameters[name].default == default


def test_the_documentation_names_every_option():
    text = tables.tables()
    for kind, one in SINGLE:
        section = text.partition(f"`{kind.__module__}.{kind.__name__}`")[2].partition("## ")[0]
        (row,) = [line for line in section.splitlines() if line.startswith(f"| `{one.name}` |")]
        assert str(one) in row
        assert filled(one.known.text) in row
    for command, one in ON_COMMANDS:
        assert re.search(rf"^\| `{one.name}` \| `--{one.flag}`.*\b{command}\b", text, re.M)
    assert "_made/options.md" in (ROOT / "docs" / "options.md").read_text()


def test_what_the_documents_type_is_there():
    known = {name for one in COMMANDS.values() for p in one.params for name in p.opts}
    known |= {name for one in COMMANDS.values() for p in one.params for name in p.secondary_opts}
    known |= {"--help", "--version", "--config-file", "--install-completion"}
    known |= {"--data", "--keep", "--only", "--out", "--table"}  # of benchmarks
    known |= {"--nthreads", "--nworkers"}  # of Dask
    for path in [ROOT / "README.md", *(ROOT / "docs").glob("*.md"), *ROOT.glob("docs/flow/*.md")]:
        typed = set(re.findall(r"(?<![\w-])--[a-z][a-z-]*", path.read_text()))
        assert typed <= known, path
