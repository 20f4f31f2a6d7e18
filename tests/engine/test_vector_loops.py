"""The law of contact becomes vector instructions (design/0005), in the code that steps as it is compiled."""

import re

import pytest
from numba.core.caching import NullCache
from tests.engine.conftest import D, elastic_law, pile

from ryusa.build import scene
from ryusa.compiled.dispatcher import Pieces
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.laws.families import ContactTiming


def text_of(made, piece="forces") -> str:
    """LLVM's text of a piece of the step of a scene, compiled here and not taken from a store."""
    engine = CpuEngine(threads=1)
    engine.load(*made)
    wanted = getattr(engine._pieces, piece)
    compiler = Pieces(wanted.function, wanted.function.pieces.targetoptions)
    compiler._cache = NullCache()
    return compiler.made(wanted.takes).library.get_llvm_str()


def elastic_pair():
    centres = [[0.0, 0.0, 0.0], [0.0, 0.0, 1.5 * D]]
    return scene(centres, D, contact=elastic_law(), dt=1.0e-7, gravity=0.0)


@pytest.mark.parametrize(
    ("made", "roots"),
    [
        # of distances
        pytest.param(lambda: pile(n=40, plane_case=True), 1, id="plane", marks=pytest.mark.full),
        # and of the spring that turns with its pair, and of the size of the tangential force
        pytest.param(lambda: pile(n=40), 3, id="space", marks=pytest.mark.full),
        pytest.param(lambda: pile(n=40, timing=ContactTiming.EXACT), 4, id="exact timing"),
        # and of overlaps
        pytest.param(elastic_pair, 9, id="Hertz", marks=pytest.mark.full),
    ],
)
def test_roots_of_the_law_are_taken_by_vectors(made, roots):
    text = text_of(made())
    assert len(re.findall(r"= .*call.* @llvm\.sqrt\.v\d+f64", text)) >= roots
    assert "call void @NRT_incref" not in text  # a count of references in the loop would hinder it, too


def test_roots_of_contacts_that_begin_and_end_within_a_step_are_taken_by_vectors():
    text = text_of(pile(n=40, timing=ContactTiming.EXACT), "shear")
    assert len(re.findall(r"= .*call.* @llvm\.sqrt\.v\d+f64", text)) >= 10
    assert "call void @NRT_incref" not in text
