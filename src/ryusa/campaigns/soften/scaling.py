"""A softer case: what goes with the stiffness, so that impacts keep their outcome and loads their arm."""

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from ryusa.casefile.builders.schema import DropSection, FromFile
from ryusa.casefile.builders.table import bed_of_run
from ryusa.casefile.derive import derive
from ryusa.casefile.row.reach import KEY
from ryusa.casefile.row.reach_source import run_of_reach
from ryusa.casefile.row.values import water_alone
from ryusa.errors import CaseError
from ryusa.laws.families import Arm, Rolling
from ryusa.study.task import CaseRun

if TYPE_CHECKING:
    from ryusa.casefile.case import Case
    from ryusa.casefile.contact.schema import RollingSection

LEAST_STEPS = 5.0  # per contact that a case may ask for


def refuse_if_not_softenable(case: "Case") -> None:
    """Refuse a case whose answer cannot be had from softer runs with other seeds.

    Raises
    ------
    CaseError : names the key.
    """
    if case.contact.stiffness is None:
        raise CaseError(
            "contact.law", case.contact.law,
            "cannot be softened: what goes with the stiffness is known for law 'linear' alone",
        )  # fmt: skip
    if case.materials:
        raise CaseError(
            "materials", ", ".join(case.materials),
            "cannot be softened: how contacts of several materials go with the stiffness is not built",
        )  # fmt: skip
    if water_alone(case):
        raise CaseError("water.row", None, "cannot be softened: it is water alone, which has no stiffness")
    if isinstance(case.build, DropSection):
        raise CaseError(
            "build.kind", case.build.kind,
            "cannot be softened: a single impact follows closed forms; `ryusa design` prints its contact "
            "time and overlap over the stiffness",
        )  # fmt: skip
    if (run := run_of_reach(case.row)) is not None:
        raise CaseError(
            KEY, run, "cannot be softened: its reach has the stiffness of the case, and softer grains need a "
            "reach of their own",
        )  # fmt: skip
    bed = bed_of_run(case.build)
    if isinstance(case.build, FromFile) or bed is not None:
        key, value = ("build.kind", case.build.kind) if bed is None else ("build.bed.run", bed.run)
        raise CaseError(
            key, value,
            "cannot be softened: its first grains are the same for every seed, so that scatter cannot be "
            "told from the effect of the stiffness; take a builder that places grains by the seed",
        )  # fmt: skip


def softened(one: CaseRun, factor: float) -> CaseRun:
    """Return the run of a case with its stiffness divided by a factor.

    Parameters
    ----------
    one : run of the case with its own stiffness.
    factor : stiffness of the case over that of the softer one [-], at least 1.

    Notes
    -----
    With k_n goes k_s, so that k_s/k_n is kept. A restitution that is given is kept by itself; constant
    dashpots go with sqrt(k), which keeps the damping ratio and so e of every pair. Where the arm of rolling
    friction is the width of the contact, b ~ sqrt(overlap), f' goes with sqrt(k): at a given load the overlap
    goes with 1/k, so that the torque f' b N is kept. A time step that is given goes with the duration of the
    contact, and the interval between two exchanges of water and grains stays as long. Friction,
    cohesion and adhesion are kept.
    """
    if factor == 1.0:
        return one
    case = one.read()
    soft = _with(one, _contact(case, factor) | _rolling(case.rolling, factor) | _time(case))
    return _with(soft, _interval(case, soft.read()))


def _with(one: CaseRun, changed: Mapping[str, str]) -> CaseRun:
    """The run with further keys set; a key displaces the other way to give the same thing."""
    before = dict(one.overrides)
    if "time.steps_per_contact" in changed:
        before.pop("time.step", None)
    return CaseRun(one.case, tuple(sorted({**before, **changed}.items())), one.cases)


def _contact(case: "Case", factor: float) -> dict[str, str]:
    contact, found = case.contact, derive(case)
    changed = {"contact.stiffness": f"{found.k_n / factor!r} N/m"}
    if contact.shear_stiffness is not None:
        changed["contact.shear_stiffness"] = f"{found.k_s / factor!r} N/m"
    for key, constant in (("damping", contact.damping), ("shear_damping", contact.shear_damping)):
        if constant:
            changed[f"contact.{key}"] = f"{constant / math.sqrt(factor)!r} N s/m"
    return changed


def _rolling(rolling: "RollingSection", factor: float) -> dict[str, str]:
    model = Rolling.of(rolling.model)
    if model is Rolling.NONE or "spring" in model.marks:
        return {}
    arm = Arm.CONTACT_WIDTH if rolling.arm is None else Arm.of(rolling.arm)
    if "varies" not in arm.marks:
        return {}
    return {"rolling.coefficient": repr(rolling.coefficient / math.sqrt(factor))}


def _time(case: "Case") -> dict[str, str]:
    if case.time.step is None:
        return {}
    return {"time.steps_per_contact": repr(max(derive(case).steps_per_contact, LEAST_STEPS))}


def _interval(case: "Case", soft: "Case") -> dict[str, str]:
    if case.water is None or case.water.profile != "column":
        return {}
    steps = case.column.interval * derive(case).dt / derive(soft).dt
    return {"water.column.interval": str(max(round(steps), 1))}
