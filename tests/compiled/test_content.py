"""What counts as the content of a function, and what does not."""

import importlib
import os
import pkgutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import ryusa
from ryusa.compiled.content import UnknownContentError, content_of, text_of
from ryusa.compiled.function import Compiled, compiled

ALL = """
import importlib, pkgutil
import ryusa
from ryusa.compiled.function import Compiled
for info in sorted(pkgutil.walk_packages(ryusa.__path__, "ryusa."), key=lambda one: one.name):
    if any(part in info.name for part in ("__main__", ".cuda", ".lammps")):
        continue
    for name, one in sorted(vars(importlib.import_module(info.name)).items()):
        if isinstance(one, Compiled):
            print(info.name, name, one.content)
"""


def compiled_functions() -> list[Compiled]:
    """Every compiled function that a module holds."""
    found: dict[int, Compiled] = {}
    for info in pkgutil.walk_packages(ryusa.__path__, "ryusa."):
        if ".cuda" in info.name or info.name.endswith("__main__"):
            continue
        for one in vars(importlib.import_module(info.name)).values():
            if isinstance(one, Compiled):
                found[id(one)] = one
    return list(found.values())


def made(text: str, **known: object):
    """The function `f` of a text."""
    room: dict[str, object] = dict(known, __name__="ryusa.made")
    exec(text, room)
    return room["f"]


def test_every_compiled_function_has_a_content():
    functions = compiled_functions()
    assert len(functions) > 500
    assert all(one.content for one in functions)  # else UnknownContentError names what has none


def test_content_is_the_same_in_every_process():
    told = [
        subprocess.run(
            [sys.executable, "-c", ALL], env={**os.environ, "PYTHONHASHSEED": seed}, capture_output=True,
            text=True, check=True,
        ).stdout
        for seed in ("1", "2")
    ]  # fmt: skip
    assert told[0] == told[1] and told[0].count("\n") > 500


def test_docstring_comments_and_place_do_not_count():
    plain = made("def f(x):\n    'One.'\n    return x + 1.0\n")
    other = made(
        "\n\n# a remark\ndef f(x):\n    '''Another,\n    longer.'''\n    # and one more\n    return x + 1.0\n"
    )
    assert content_of(plain) == content_of(other)


@pytest.mark.parametrize(
    "text",
    [
        "def f(x):\n    return x + 2.0\n",
        "def f(x):\n    return x - 1.0\n",
        "def f(x):\n    return 1.0 + x\n",
        "def f(y):\n    return y + 1.0\n",
        "def f(x, y=1.0):\n    return x + 1.0\n",
        "def f(x):\n    return x + 1\n",
    ],
)
def test_what_a_function_does_counts(text):
    assert content_of(made("def f(x):\n    return x + 1.0\n")) != content_of(made(text))


@pytest.mark.parametrize(
    ("first", "second"),
    [
        (1.0, 2.0), (1, 1.0), (1, True), (0.0, -0.0), ((1, 2), (1, 3)), (np.ones(2), np.ones(3)),
        (np.float64(1.0), np.float64(2.0)), (None, 0), (np.int32, np.int64), ("a", b"a"),
    ],
)  # fmt: skip
def test_the_value_of_a_global_counts(first, second):
    text = "def f(x):\n    return x + K\n"
    assert content_of(made(text, K=first)) != content_of(made(text, K=second))
    assert content_of(made(text, K=first)) == content_of(made(text, K=first))


def test_a_constant_of_another_module_counts(monkeypatch):
    from ryusa.engine.cpu import batch_layout as layout

    function = made("def f(x):\n    return x + B.LANES\n", B=layout)
    before = content_of(function)
    monkeypatch.setattr(layout, "LANES", layout.LANES + 1)
    assert content_of(function) != before


def test_what_a_function_calls_counts_and_so_does_what_that_calls():
    texts = ("def f(x):\n    return x\n", "def f(x):\n    return -x\n")
    chains = []
    for text in texts:
        inmost = compiled()(made(text))
        middle = compiled()(made("def f(x):\n    return g(x)\n", g=inmost))
        chains.append(content_of(made("def f(x):\n    return g(x)\n", g=middle)))
    assert chains[0] != chains[1]


def test_options_and_what_a_closure_holds_count():
    text = made("def f(x):\n    return x\n")
    assert compiled(nogil=True)(text).content != compiled()(text).content

    def closing(k):
        return lambda x: x + k

    assert content_of(closing(1.0)) != content_of(closing(2.0))


def test_a_function_of_no_module_has_a_content():
    function = made("def f(x):\n    return x\n")
    function.__module__ = None
    assert content_of(function)


def test_what_has_no_content_is_refused_not_guessed():
    with pytest.raises(UnknownContentError, match="has no content"):
        content_of(made("def f(x):\n    return x + K\n", K=object()))


def test_a_law_that_a_method_or_attribute_of_the_same_name_hides_is_not_its_content():
    function = "def f(x):\n    return k.power(x)\n"
    assert content_of(made(function, k=1.0, power=1.0)) == content_of(made(function, k=1.0, power=2.0))


def test_the_text_of_a_module_that_extends_numba_counts(tmp_path: Path):
    first, second, third = (tmp_path / f"{k}.py" for k in range(3))
    first.write_text('"""One."""\nx = 1  # one\n')
    second.write_text('"""Two."""\n\nx = 1\n')
    third.write_text('"""One."""\nx = 2\n')
    assert text_of(first) == text_of(second) != text_of(third)
