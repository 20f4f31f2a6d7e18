"""What holds for every law, whatever it says."""

import inspect
import math
from pathlib import Path

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from tests.laws.conftest import TABLES

import ryusa.laws

# Laws that may answer with a number although an argument is not one, and why that hides nothing.
BLIND = {
    ("adhesion.sticking_speed_hertz", "pull"),  # one of the two attractions is 0
    ("walls.nearest_on_cylinder", "length"),  # the end, of a point that is not beyond it
    *(("walls.nearest_on_triangle", name) for name in ("s_11", "s_12", "s_22")),  # of a face in the scene
    # moduli have no effect where both materials have one Poisson's ratio, as here
    *(("materials.poisson_of_two", name) for name in ("young_a", "young_b")),
    ("contact.slip_scale", "size"),  # a factor of the vector that is not a number itself
    ("contact.slip_scale", "tau_c"),  # tau_c comes from the normal force, which is not a number either
    ("contact.slip_spring", "spring_n"),
    ("contact.slide", "size"),
    ("contact.slide", "tau_c"),
    # the step of a contact: not used in a plane
    ("kick_and_shear.time_of_release", "q"),  # of a pair whose stiffness is no number: then its force is none
    *(("contact_step.contact_force", name) for name in ("n_y", "h_y", "h_z")),
    *(("contact_step.contact_kinematics", name) for name in ("d_y", "u_y", "w_ix", "w_iz", "w_jx", "w_jz")),
    ("contact_step.contact_kinematics", "dt"),
    *(("contact_step.tangential_step", name) for name in ("n_x", "n_y", "n_z", "twist", "s_y", "s_z")),
    *(("contact_step.tangential_step", name) for name in ("f_n", "e_n", "cohesion", "mu")),  # of tau_c
    # of tau_c; the normal force, which is no number either, comes from touch_in_step and part_in_step
    *(("slip_within_step.slip_within_step", name) for name in ("y", "rate", "a", "q", "m", "cohesion", "mu")),
    ("contact_step.tangential_step", "soft_s"),  # used while sliding
    ("contact_step.normal_step", "overlap"),  # comes from positions, which the grain step looks at
    ("contact_step.normal_step", "least"),  # 0 or -inf
    ("contact_step.normal_work_of_last_force", "least"),
    ("contact_step.normal_work_of_last_force", "soft_n"),
    ("contact.slip_spring", "cohesion"),
    ("contact.slip_spring", "mu"),
    ("debris.equilibrium_concentration", "rho_s"),  # infinite on too steep a slope, whatever the densities
    ("debris.equilibrium_concentration", "rho_w"),
    ("debris.equilibrium_takahashi", "rho_s"),  # the cap, likewise
    ("debris.equilibrium_takahashi", "rho_w"),
    ("debris.equilibrium_takahashi", "c_star"),
    ("eddies.eddy_along", "shear"),  # its sign
    ("geometry.wrap", "period"),  # checked by the case reader
    ("hertz_step.normal_step_hertz", "overlap"),  # as in contact_step.normal_step
    ("hertz_step.normal_step_hertz", "least"),
    ("hertz_step.normal_work_hertz", "overlap"),
    ("hertz_step.normal_work_hertz", "least"),
    ("hertz_step.shear_spring_hertz", "root"),  # of the overlap, which the grain step looks at
    ("hertz_step.shear_spring_hertz", "root_old"),
    # not used in a plane, or of tau_c, as in contact_step.tangential_step
    *(("hertz_step.tangential_step_hertz", name) for name in ("n_x", "n_y", "n_z", "twist", "s_y", "s_z")),
    *(("hertz_step.tangential_step_hertz", name) for name in ("f_n", "e_n", "cohesion", "mu")),
    ("rolling.epsd_torque", "spin"),  # the dashpot is off while sliding
    ("rolling.epsd_torque", "eta_r"),
    ("rolling.epsd_torque", "scale"),
    ("rolling.rolling_constant", "cap"),  # comes from the normal force
    ("rolling.rolling_limited", "cap"),  # likewise
    ("torque.torque_in_range", "spin"),  # yes or no
    ("torque.torque_in_range", "d"),
    ("torque.torque_in_range", "nu"),
    ("torque.torque_stokes", "spin"),  # does not depend on it
    ("transport.bedload_layer", "tau_star"),  # infinite on too steep a slope, whatever the rest
    ("transport.bedload_layer", "c_s"),
    ("water.still", "z"),
    ("water.uniform", "z"),
}


def test_every_module_of_the_room_holds_laws(laws):
    files = {path.stem for path in Path(ryusa.laws.__path__[0]).glob("[!_]*.py")} - TABLES
    assert {name.split(".")[0] for name in laws} == files


def test_a_law_names_its_units_and_shows_an_example(law):
    text = inspect.getdoc(law.plain)
    assert text
    assert ">>>" in text
    assert "[" in text.split(">>>")[0]
    assert set(law.kinds) <= {float, bool}
    assert inspect.signature(law.plain).return_annotation is not inspect.Signature.empty


@settings(max_examples=15)
@given(data=st.data())
def test_compiled_and_plain_python_agree(law, data):
    args = data.draw(law.draw())
    try:
        plain = law.plain(*args)
    except (
        ValueError,
        ZeroDivisionError,
        OverflowError,
    ):  # plain Python raises where compiled gives inf or nan
        assume(False)
    expected = list(plain) if isinstance(plain, tuple) else [plain]
    assert law(*args) == pytest.approx(expected, rel=1e-11, abs=1e-12, nan_ok=True)


def test_nan_is_passed_on(law):
    for k, (argument, kind) in enumerate(zip(law.arguments, law.kinds, strict=True)):
        if kind is bool or (law.name, argument) in BLIND:
            continue
        args = [True if kind is bool else 0.5 for kind in law.kinds]
        args[k] = math.nan
        assert any(math.isnan(x) for x in law(*args)), argument
