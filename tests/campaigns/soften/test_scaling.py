"""What a softer case keeps and what goes with its stiffness."""

import math
import shutil

import pytest

from ryusa.campaigns.soften.scaling import refuse_if_not_softenable, softened
from ryusa.casefile.builders.schema import BedOfRunSection
from ryusa.casefile.derive import derive
from ryusa.cases import case_path
from ryusa.errors import CaseError
from ryusa.laws.rolling import rolling_arm_width
from ryusa.study import case_run

BY_RESTITUTION = ("bedload_3d", "heap", "saltation", "validation/incline", "settling_column")
BY_DASHPOT = ("dense_3d", "dense_plane", "paper/fig17")


def task(name, **changes):
    return case_run(case_path(f"{name}.toml"), {key.replace("__", "."): one for key, one in changes.items()})


@pytest.mark.parametrize("factor", [2.0, 16.0, 100.0])
@pytest.mark.parametrize("name", [*BY_RESTITUTION, *BY_DASHPOT])
def test_e_of_every_pair_ks_over_kn_and_mu_are_kept(name, factor):
    one = task(name)
    own, soft = derive(one.read()), derive(softened(one, factor).read())
    assert soft.k_n == pytest.approx(own.k_n / factor, rel=1e-12)
    assert soft.k_s / soft.k_n == pytest.approx(own.k_s / own.k_n, rel=1e-12)
    assert soft.mu == own.mu
    for pair in ("fixed", "free"):
        for ratio in ("e", "e_s", "zeta_n", "zeta_s"):
            assert getattr(getattr(soft, pair), ratio) == pytest.approx(
                getattr(getattr(own, pair), ratio), rel=1e-9
            )


@pytest.mark.parametrize("name", [*BY_RESTITUTION, *BY_DASHPOT])
def test_steps_become_longer_with_the_duration_of_contacts(name):
    one = task(name)
    own, soft = derive(one.read()), derive(softened(one, 16.0).read())
    assert soft.dt / own.dt == pytest.approx(4.0, rel=1e-9)
    assert soft.steps_per_contact == pytest.approx(own.steps_per_contact, rel=1e-9)


def test_a_time_step_that_is_given_becomes_longer_too():
    one = task("heap", time__step="2 us")
    own, soft = derive(one.read()), derive(softened(one, 4.0).read())
    assert own.dt == pytest.approx(2.0e-6)
    assert soft.dt == pytest.approx(4.0e-6)


def test_a_tangential_stiffness_that_is_given_goes_with_the_normal_one():
    one = task("heap", contact__shear_stiffness="40 N/cm")
    assert derive(softened(one, 4.0).read()).k_s == pytest.approx(1000.0)


@pytest.mark.parametrize("rule", ['{ overlap = 0.01, speed = "0.5 m/s" }', '{ collision_time = "1e-4 s" }'])
def test_a_stiffness_given_by_a_rule_is_divided_too(rule):
    one = task("heap", contact__stiffness=rule)
    own, soft = derive(one.read()), derive(softened(one, 9.0).read())
    assert soft.k_n == pytest.approx(own.k_n / 9.0, rel=1e-12)


@pytest.mark.parametrize("model", ["printed", "constant"])
def test_f_of_a_contact_width_keeps_the_torque_of_a_given_load(model):
    one = task("heap", rolling__model=model, rolling__coefficient="0.4", rolling__arm="contact width")
    own, soft = (softened(one, factor).read() for factor in (1.0, 100.0))
    r, load, k_n = 1.0e-3, 1.0e-4, derive(own).k_n
    torque = [
        case.rolling.coefficient * rolling_arm_width(r, r, load / k) * load
        for case, k in ((own, k_n), (soft, k_n / 100.0))
    ]
    assert torque[1] == pytest.approx(torque[0], rel=1e-3)
    assert soft.rolling.coefficient == pytest.approx(0.04)


@pytest.mark.parametrize("arm", ["reduced radius", None])
def test_a_rolling_coefficient_of_the_radius_is_kept(arm):
    model = "constant" if arm else "spring-dashpot-slider"
    changes = {"rolling__model": model, "rolling__coefficient": "0.1"} | (
        {"rolling__arm": arm} if arm else {}
    )
    assert softened(task("heap", **changes), 16.0).read().rolling.coefficient == 0.1


def test_cohesion_is_a_force_and_is_kept():
    one = task("heap", contact__cohesion="1e-5 N")
    assert softened(one, 16.0).read().contact.cohesion == 1.0e-5


def test_water_and_grains_meet_after_the_same_time():
    one = task("bedload_3d")
    own, soft = one.read(), softened(one, 16.0).read()
    times = [case.water.column.interval * derive(case).dt for case in (own, soft)]
    assert times[1] == pytest.approx(times[0], rel=0.04)  # a whole number of steps
    assert soft.water.column.interval == round(33 / 4)


def test_the_stiffness_of_the_case_itself_is_its_own_run():
    one = task("heap")
    assert softened(one, 1.0) == one


def test_changes_to_the_case_are_kept():
    one = task("heap", contact__restitution="0.5", stop__time="1 s")
    soft = softened(one, 4.0).read()
    assert (soft.contact.restitution, soft.stop.time) == (0.5, 1.0)


def test_a_single_impact_water_alone_and_grains_from_a_file_are_refused_by_name(tmp_path):
    with pytest.raises(CaseError, match=r"build.kind = 'drop': cannot be softened.*ryusa design"):
        refuse_if_not_softenable(task("drop").read())
    with pytest.raises(CaseError, match=r"water.row: cannot be softened: it is water alone"):
        refuse_if_not_softenable(task("weir").read())
    shutil.copy(case_path("validation/frey_2014.csv"), tmp_path / "grains.csv")
    text = case_path("heap.toml").read_text(encoding="utf-8")
    build, timeline = text.index("[build]"), text.index("[[timeline]]")
    table = '[build]\nkind = "table"\nfile = "grains.csv"\n\n[time]\nsteps_per_contact = 10\n\n'
    end = text.index("[stop]", timeline)
    (tmp_path / "case.toml").write_text(text[:build] + table + text[end:], encoding="utf-8")
    (tmp_path / "grains.csv").write_text("x [m],z [m],d [m]\n0,0.01,0.002\n", encoding="utf-8")
    with pytest.raises(CaseError, match=r"build.kind = 'table': cannot be softened.*same for every seed"):
        refuse_if_not_softenable(case_run(tmp_path / "case.toml").read())


def test_rivers_that_take_from_another_run_are_refused_by_the_key_of_that_run():
    case = task("fed_river").read()
    bed = case.build.model_copy(update={"bed": BedOfRunSection(run="runs/settled")})
    with pytest.raises(CaseError, match=r"build.bed.run = 'runs/settled': cannot be softened"):
        refuse_if_not_softenable(case.model_copy(update={"build": bed}))
    row = case.water.row
    end = row.upstream.model_copy(update={"end": "feeder reach", "run": "runs/even"})
    water = case.water.model_copy(update={"row": row.model_copy(update={"upstream": end})})
    with pytest.raises(CaseError, match=r"water.row.upstream.run = 'runs/even': cannot be softened"):
        refuse_if_not_softenable(case.model_copy(update={"water": water}))


def test_every_case_of_the_package_can_be_softened_but_those_that_say_why_not():
    from ryusa.cases import case_files

    for name, path in case_files().items():
        if name in {"drop", "weir", "direct_shear"}:  # one grain, water alone, walls of another material
            continue
        one = case_run(path)
        refuse_if_not_softenable(one.read())
        assert math.isclose(derive(softened(one, 4.0).read()).k_n, derive(one.read()).k_n / 4.0)
