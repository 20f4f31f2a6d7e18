import numpy as np
import pytest

from ryusa.measure import collisions, grouping, saltation

RISES = [2.0e-3, 3.0e-3, 1.0e-3, 4.0e-3, 2.5e-3, 1.5e-3]


def one(make, **how):
    t, x, v, events = make.hopping(RISES, **how)
    return make.run_of(t, x[:, None], v[:, None], events)


def flight_time(rise, drop, g):
    return np.sqrt(2 * rise / g) + np.sqrt(2 * (rise + drop) / g)


@pytest.mark.parametrize("interval", [2.0e-4, 1.0e-3, 7.0e-3, 1.0])
def test_ballistic_hops_give_their_height_whatever_the_frame_interval(make, interval):
    found = saltation(one(make, interval=interval))
    np.testing.assert_allclose(found.hops["rise"], RISES, rtol=1e-9)
    assert found["jump_height"].value == pytest.approx(np.mean(RISES), rel=1e-9)
    assert found["jump_height"].n == len(RISES)


def test_height_above_the_crest_counts_from_a_grain_that_stands_on_it(make):
    found = saltation(one(make))
    top = found.hops["z_takeoff"] + found.hops["rise"]
    np.testing.assert_allclose(found.hops["above_crest"], top - 1.5 * make.d, atol=1e-15)


def test_length_is_from_landing_to_landing(make):
    found = saltation(one(make, u=0.25))
    np.testing.assert_allclose(found.hops["length"], 0.25 * found.hops["period"], rtol=1e-9)
    np.testing.assert_allclose(found.hops["flight_length"], 0.25 * found.hops["flight_time"], rtol=1e-9)
    np.testing.assert_allclose(found.hops["period"] - found.hops["flight_time"], make.t_col, rtol=1e-6)
    assert found["speed"].value == pytest.approx(0.25, rel=1e-9)


def test_flight_times_are_ballistic(make):
    found = saltation(one(make))
    expected = flight_time(found.hops["rise"], found.hops["z_takeoff"] - 1.9e-3, make.g)
    np.testing.assert_allclose(found.hops["flight_time"], expected, rtol=1e-9)


def test_bounces_before_the_settling_time_are_left_out(make):
    run = one(make)
    all_of_them = saltation(run)
    late = saltation(run, settle=float(all_of_them.hops["t_begin"][2]) - 1e-6)
    assert len(late.hops) == len(RISES) - 2
    assert late["jump_height"].value == pytest.approx(np.mean(RISES[2:]), rel=1e-9)


def test_a_low_flight_joins_two_contacts_into_one_bounce(make):
    t, x, v, events = make.hopping([2.0e-3, 0.05e-3, 3.0e-3, 2.0e-3])
    run = make.run_of(t, x[:, None], v[:, None], events)
    found = saltation(run, rise=0.1)
    assert found.bounces["n_contact"].tolist() == [1, 2, 1]
    np.testing.assert_allclose(found.hops["rise"], [2.0e-3, 3.0e-3, 2.0e-3], rtol=1e-6)
    assert found.bounces["omega_before"].tolist() == [0.0, 10.0, 30.0]
    assert found.bounces["omega_after"].tolist() == [10.0, 30.0, 40.0]
    counts = [len(each.hops) for each in grouping(run, rises=(0.0, 0.1, 1.4))]
    assert counts == [4, 3, 1]


def test_contacts_that_overlap_in_time_are_one_bounce(make):
    t, x, v, events = make.hopping([2.0e-3, 3.0e-3])
    second = events[1].copy()
    second["j"] += 1
    second["t_begin"] += 0.5 * make.t_col
    run = make.run_of(t, x[:, None], v[:, None], np.append(events, second))
    found = saltation(run)
    assert found.bounces["n_contact"].tolist() == [1, 2]
    assert found.contact_time.tolist() == pytest.approx([make.t_col, make.t_col, 0.5 * make.t_col])


def test_bed_shear_over_normal_is_the_ratio_of_impulses(make):
    found = saltation(one(make))
    assert found["shear_ratio"].value == pytest.approx(0.3, rel=1e-9)
    time = found.hops["period"].sum()
    assert found["bed_normal"].value == pytest.approx(found.hops["impulse_normal"].sum() / time)
    # over many hops the bed carries the weight
    assert found["bed_normal"].value == pytest.approx(make.m * make.g, rel=0.05)


def test_starts_are_pooled_and_their_hops_counted(make):
    lanes = [make.hopping(RISES, grain=g, n_grain=3, start=0.001 * g) for g in range(3)]
    n = min(len(lane[0]) for lane in lanes)
    x = np.stack([lane[1][:n] for lane in lanes], axis=1)
    v = np.stack([lane[2][:n] for lane in lanes], axis=1)
    events = np.concatenate([lane[3] for lane in lanes])
    run = make.run_of(lanes[0][0][:n], x, v, events)
    found = saltation(run, hops=4, grains=[0])
    assert found["jump_height"].n == 4
    pooled = saltation(run)
    assert pooled["contact_time"].n_series == 3
    assert pooled["contact_time"].value == pytest.approx(make.t_col)


def test_eq_8_is_given_without_and_with_added_mass(make):
    times = saltation(one(make)).times
    assert times.eq_8 == pytest.approx(np.pi * np.sqrt(make.m / 1.0e4))
    assert times.added == pytest.approx(np.pi * np.sqrt((make.m + make.added) / 1.0e4))
    assert times.damped == pytest.approx(times.added / np.pi * 2.9184, rel=1e-4)


def test_a_grain_that_never_touches_has_no_hops(make):
    t, x, v, events = make.hopping(RISES)
    run = make.run_of(t, x[:, None], v[:, None], events[:0])
    found = saltation(run)
    assert len(found.hops) == 0
    assert found["jump_height"].n == 0


def test_collisions_give_back_restitution_and_share_of_eq_8(make):
    rows = [make.event(0, 1 + k, 0.01 * k, (0.0, 0.0019), (0.2, -0.5), (-0.1, 0.35)) for k in range(5)]
    rows[4]["alone"] = 0.0
    run = make.run_of(np.zeros(2), np.zeros((2, 1, 3)), np.zeros((2, 1, 3)), np.array(rows))
    found = collisions(run, partner="bed", settle=0.005)
    assert len(found.events) == 4
    assert found.averages["restitution_alone"].value == pytest.approx(0.7)
    assert found.averages["restitution_alone"].n == 3
    assert found.averages["restitution_shear_alone"].value == pytest.approx(0.5)
    assert found.averages["overlap_over_d"].value == pytest.approx(0.005)
    np.testing.assert_allclose(found.expected, 2.9184 * np.sqrt((make.m + make.added) / 1.0e4), rtol=1e-4)
    assert len(collisions(run, partner="free").events) == 0


def test_a_contact_whose_bed_grain_was_taken_away_counts_but_has_no_length(make):
    t, x, v, events = make.hopping([2.0e-3] * 4)
    whole = make.run_of(t, x[:, None], v[:, None], events)
    cut = events.copy()
    cut["closing_end"][1], cut["alone"][1] = np.nan, 0.0
    cut["t_end"][1] = cut["t_begin"][1] + 0.1 * make.t_col
    cut["slip_end"][1] = np.nan
    run = make.run_of(t, x[:, None], v[:, None], cut)
    assert len(saltation(run).bounces) == len(saltation(whole).bounces)
    np.testing.assert_allclose(saltation(run).contact_time, make.t_col)
    assert len(saltation(run).contact_time) == len(saltation(whole).contact_time) - 1


def test_restitution_leaves_out_contacts_whose_partner_was_taken_away(make):
    t, x, v, events = make.hopping([2.0e-3] * 4)
    cut = events.copy()
    cut["closing_end"][1] = np.nan
    found = collisions(make.run_of(t, x[:, None], v[:, None], cut), "bed")
    assert len(found.events) == len(events)
    assert np.isnan(found.restitution[1])
    assert np.isnan(found.duration[1])
    assert np.isfinite(np.delete(found.restitution, 1)).all()
    assert found.averages["duration"].n == len(events) - 1


def test_the_begin_of_steady_hops_is_told_from_all_hops_beside_the_settling_of_the_case(make):
    """Jumps rise from 0.5 to 2.5 mm within some ten of sixty hops."""
    rises = 2.5e-3 - 2.0e-3 * np.exp(-np.arange(60) / 4.0) + 1.0e-4 * np.sin(np.arange(60) ** 2)
    t, x, v, events = make.hopping(rises, n_grain=4)  # the first of four, over a bed that is long enough
    run = make.run_of(t, x[:, None].repeat(4, 1), v[:, None].repeat(4, 1), events, settle=0.05)
    note = saltation(run, grains=[0]).averages.notes[0]
    assert note.startswith("MSER suggests a window for jump_height from t = ")
    assert note.endswith("the case settles until 0.05 s")
    began = float(note.split("t = ")[1].split(" s")[0])
    hops = saltation(run, settle=0.0, grains=[0]).hops
    assert len(hops) == 60
    assert 4 < np.searchsorted(hops["t_begin"], began) < 40
    assert "the window begins at 0.2 s" in saltation(run, settle=0.2, grains=[0]).averages.notes[0]
    assert "too few samples" in saltation(one(make)).averages.notes[0]


def oblique(make, *, force, friction):
    """Hops of a grain that hits the upstream side of a crest with a normal and a tangential impulse [N s]."""
    t, x, v, events = make.hopping(RISES)
    normal = np.array([-0.6, 0.0, 0.8])
    scene = make.scene()
    events["impulse_n"] = force
    events["impulse"] = force * normal - friction * np.array([0.8, 0.0, 0.6])
    moved = 0.5 * make.t_col * (0.75 * events["v_begin"] + 0.25 * events["v_end"])
    events["x_begin"] = scene.x_fixed[events["j"] - 1] + make.d * normal - moved
    events["x_begin"][:, 0] += 3.0 * scene.period[0]  # after three rounds of the periodic bed
    return saltation(make.run_of(t, x[:, None], v[:, None], events))


def test_friction_is_what_the_normal_force_leaves_of_the_shear_on_the_bed(make):
    smooth = oblique(make, force=1.0e-6, friction=0.0)
    np.testing.assert_allclose(smooth.hops["impulse_shear"], 0.6e-6, rtol=1e-9)
    np.testing.assert_allclose(smooth.hops["impulse_friction"], 0.0, atol=1e-15)
    rough = oblique(make, force=1.0e-6, friction=0.5e-6)
    np.testing.assert_allclose(rough.hops["impulse_shear"], 1.0e-6, rtol=1e-9)
    np.testing.assert_allclose(rough.hops["impulse_friction"], 0.4e-6, rtol=1e-9)
    time = rough.hops["period"].sum()
    assert rough["bed_friction"].value == pytest.approx(rough.hops["impulse_friction"].sum() / time)
