"""Picture of the energy account."""

import numpy as np

from ryusa import figures
from ryusa.measure import Energy
from ryusa.measure.energy import TERMS
from ryusa.model.tally import GIFTS, HELD, LOSSES

GIVEN, LOST = ([term.name.lower() for term in terms] for terms in (GIFTS, LOSSES))


def test_energy_terms_that_stay_zero_are_left_out():
    t = np.linspace(0, 1, 10)
    zero = np.zeros(10)
    found = Energy(t, {"kinetic": t, "spin": zero}, {"dash_n": zero}, {"drag": t}, 0.0, zero)
    figure = figures.energy(found)
    labels = [line.get_label() for axes in figure.axes for line in axes.lines]
    assert any("kinetic" in one for one in labels)
    assert any("drag" in one for one in labels)
    assert not any("spin" in one or "dashpot" in one for one in labels)


def drawn_terms(held=(), given=(), lost=()):
    """Label of each term in the picture of the energy account, and its colour and line."""
    t = np.linspace(0.0, 1.0, 10)
    account = Energy(t, *(dict.fromkeys(terms, t) for terms in (held, lost, given)), 0.0, 0.0 * t)
    lines = [line for axes in figures.energy(account).axes for line in axes.lines]
    named = [line for line in lines if not line.get_label().startswith("_")]
    return {line.get_label(): (line.get_color(), str(line.get_linestyle())) for line in named}


def test_an_energy_term_has_one_colour_whichever_terms_are_drawn_and_no_two_look_alike():
    every = drawn_terms(HELD, GIVEN, LOST)
    alone = [drawn_terms(held=[term]) for term in HELD] + [
        drawn_terms(["kinetic"], given=[term]) for term in GIVEN
    ]
    alone += [drawn_terms(["kinetic"], lost=[term]) for term in LOST]
    assert len(alone) == len(TERMS)
    for one in alone:
        assert one.items() <= every.items()
    flow = [look for label, look in every.items() if label[0] in "+–"]
    assert len(set(flow)) == len(flow) == len(GIVEN) + len(LOST)
    held = [look for label, look in every.items() if label in TERMS.values() or label.startswith("potential")]
    assert len(set(held)) == len(held) == len(HELD)
