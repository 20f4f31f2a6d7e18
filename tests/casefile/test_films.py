"""Keys of films between grains: what is missing, what has no effect, and what a check explains."""

from collections.abc import Callable

import pytest

from ryusa.build import build
from ryusa.casefile import Case, explain
from ryusa.errors import CaseError
from ryusa.laws import immersed
from ryusa.laws.families import Rebound

CaseOf = Callable[..., Case]


def wet(case: CaseOf, keys: str, **others: str) -> Case:
    return case(
        water=f"{{profile = 'still', {keys}}}", **{k.replace("__", "."): v for k, v in others.items()}
    )


@pytest.mark.parametrize(
    ("keys", "others", "key", "part"),
    [
        ("rebound = 'Davis'", {}, "water.asperity", "missing; rebound 'Davis'"),
        ("film = 'lubrication'", {}, "water.asperity", "missing; film 'lubrication'"),
        ("asperity = '10 um'", {}, "water.asperity", "no effect with rebound 'dry'"),
        ("rebound = 'Davis', asperity = '2 mm'", {}, "water.asperity", "below the mean radius"),
        ("rebound_stokes = 30.0", {}, "water.rebound_stokes", "no effect with rebound 'dry'"),
        ("rebound_least = 0.1", {}, "water.rebound_least", "no effect with rebound 'dry'"),
        ("rebound = 'exponential', rebound_least = 0.8", {}, "water.rebound_least", "must not be above"),
        ("film_reach = '1 mm'", {}, "water.film_reach", "no effect with film 'none'"),
        (
            "film = 'lubrication', asperity = '10 um', film_reach = '3 mm'", {}, "water.film_reach",
            "mean diameter",
        ),
        (
            "film = 'lubrication', asperity = '10 um', rebound = 'exponential'", {}, "water.film",
            "which includes the film",
        ),
        ("film = 'lubrication', asperity = '1 nm', viscosity = '1e-4 m2/s'", {}, "water.asperity", "resolve"),
        (
            "rebound = 'exponential', rebound_least = 0.0001", {"time__steps_per_contact": "10"},
            "water.rebound_least", "needs a step below",
        ),
    ],
)  # fmt: skip
def test_films_that_cannot_be_are_refused(
    case: CaseOf, keys: str, others: dict[str, str], key: str, part: str
) -> None:
    with pytest.raises(CaseError) as caught:
        wet(case, keys, **others)
    assert key in str(caught.value)
    assert part in str(caught.value)


def test_a_rebound_needs_a_restitution_in_air(case: CaseOf) -> None:
    with pytest.raises(CaseError, match="restitution"):
        wet(
            case,
            "rebound = 'exponential'",
            contact="{stiffness = '1e4 N/m', damping = '0.1 N s/m', friction = 0.5}",
        )


def test_keys_of_films_reach_the_scene(case: CaseOf) -> None:
    water = build(wet(case, "rebound = 'Davis', asperity = '20 um', rebound_least = 0.05")).scene.water
    assert (water.rebound, water.asperity, water.e_least) == (Rebound.DAVIS, 2e-5, 0.05)
    assert water.film_reach == 0.0
    water = build(wet(case, "film = 'lubrication', asperity = '20 um'")).scene.water
    assert (water.rebound, water.film_reach) == (Rebound.DRY, pytest.approx(0.25 * 2e-3))


def test_check_prints_the_rebound_of_a_settling_grain(case: CaseOf) -> None:
    rows = {row.name: row.value for row in explain(wet(case, "rebound = 'exponential'"))}
    st = rows["Stokes number"]
    assert rows["restitution under water"] == pytest.approx(immersed.restitution_exponential(0.7, st, 35.0))
    assert "Stokes number" not in {row.name for row in explain(wet(case, "drag = 'constant'"))}
