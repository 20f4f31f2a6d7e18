"""Pictures are looked at by people; here: that they are drawn, show what they are given and are written."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.collections import EllipseCollection

from ryusa import figures
from ryusa.build.walls import rectangle, with_walls
from ryusa.measure import ContactTimes, HeapSurface, Snapshot, Tracks, Vibration
from ryusa.model import EVENT, ContactLaw, Scene

D = 0.002


def path(n=200, length=0.3):
    x = np.linspace(0.05, 0.05 + length, n)
    bed = (np.arange(20) + 0.5) * D
    return Tracks(
        grains=(0,),
        t=np.linspace(1, 2, n),
        x=x[:, None],
        z=(0.003 + 0.004 * np.abs(np.sin(60 * x)))[:, None],
        d=np.array([D]),
        bed_x=bed,
        bed_z=np.full(20, D / 2),
        bed_d=np.full(20, D),
        loose_x=bed[:3],
        loose_z=np.full(3, 1.4 * D),
        loose_d=np.full(3, D),
        period=20 * D,
    )


def test_a_long_track_is_cut_into_panels_with_round_grains_and_a_bed_without_gaps():
    figure = figures.tracks(path())
    figure.canvas.draw()
    assert len(figure.axes) == 4
    assert figure.get_supylabel() == "height above datum  $z$  (mm)"
    for axes in figure.axes:
        assert axes.get_aspect() == 1.0
        loose, bed = (one for one in axes.collections if isinstance(one, EllipseCollection))
        low, high = axes.get_xlim()
        assert len(bed.get_offsets()) >= (high - low) / (1e3 * D)
        assert np.diff(np.sort(bed.get_offsets()[:, 0])) == pytest.approx(1e3 * D)
        assert bed.get_widths() == pytest.approx(1e3 * D)
        assert len(loose.get_offsets()) >= 3 * math.floor((high - low) / (20e3 * D))
        assert loose.get_offsets()[:, 1] == pytest.approx(1.4e3 * D)


def test_a_path_high_for_its_length_leaves_no_panel_empty():
    high = replace(path(), z=20.0 * path().z)
    for axes in figures.tracks(high).axes:
        assert any(np.isfinite(line.get_xdata()).any() for line in axes.lines)


def test_a_path_is_drawn_to_the_edge_of_its_panel_however_few_its_frames():
    few = path(n=12)
    for axes in figures.tracks(few).axes[:-1]:
        drawn = [x for line in axes.lines for x in line.get_xdata() if np.isfinite(x)]
        assert max(drawn) >= axes.get_xlim()[1]


def test_steps_longer_than_a_diameter_are_dashed_between_dots_and_the_caption_says_so():
    whole = path()
    assert "dashed" not in figures.tracks(whole).axes[0].get_title(loc="left")
    keep = np.r_[0:80, 90:200]  # ten frames are missing: a gap of 8 D
    gap = replace(whole, t=whole.t[keep], x=whole.x[keep], z=whole.z[keep])
    figure = figures.tracks(gap, panels=1)
    solid, dashed, dots = figure.axes[0].lines
    apart = [1e3 * gap.x[79, 0], 1e3 * gap.x[80, 0]]
    assert list(dashed.get_xdata()[:2]) == pytest.approx(apart)
    assert dashed.get_linestyle() == "--"
    assert list(dots.get_xdata()) == pytest.approx(apart)
    steps = np.diff(np.asarray(solid.get_xdata(), dtype=float))
    assert np.nanmax(steps) <= 1e3 * D
    assert np.isnan(steps).sum() == 2  # the solid line is broken there, and only there
    assert "frames (dots) more than a diameter apart" in figure.axes[0].get_title(loc="left")
    pair = figures.tracks_side_by_side({"fine": whole, "coarse": gap}, 0.3)
    assert "frames (dots) more than a diameter apart" in pair.axes[0].get_title(loc="right")


def test_the_caption_says_which_free_grains_are_drawn():
    alone = replace(path(), **{f"loose_{name}": np.zeros(0) for name in "xzd"})
    assert "blue grains: free" in figures.tracks(path()).axes[0].get_title(loc="left")
    assert "blue grains" not in figures.tracks(alone).axes[0].get_title(loc="left")
    hidden = figures.tracks(alone, around=moment()).axes[0].get_title(loc="left")  # two more grains
    assert "other free grains are not drawn" in hidden
    seen = figures.tracks(alone, around=moment(grains=np.arange(1))).axes[0].get_title(loc="left")
    assert "not drawn" not in seen


def test_an_exaggeration_of_heights_is_stated():
    figure = figures.tracks(path(), panels=2, exaggeration=2.0)
    assert "2 times" in figure.axes[0].get_title(loc="right")


def test_tracks_side_by_side_share_their_scale():
    figure = figures.tracks_side_by_side({"a": path(), "b": path(length=0.4)}, 0.2)
    assert len({axes.get_xlim() for axes in figure.axes}) == 1
    assert len({axes.get_ylim() for axes in figure.axes}) == 1


def test_measured_points_carry_error_bars_and_the_axes_their_units():
    k = np.logspace(2, 5, 4)
    points = figures.StiffnessPoints("run", k, 1 / np.sqrt(k), 0.1 / np.sqrt(k))
    figure = figures.over_stiffness("time", [figures.StiffnessCurve("Eq. (8)", k, 1 / np.sqrt(k))], [points])
    axes = figure.axes[0]
    assert axes.get_xlabel().endswith("(N/m)")
    assert axes.get_ylabel().endswith("(s)")
    assert len(axes.containers) == 1
    low, high = axes.get_xlim()
    assert low < k[0]
    assert high > k[-1]


@pytest.mark.parametrize("kind", [".png", ".svg"])
def test_the_same_picture_is_written_with_the_same_bytes(tmp_path, kind):
    first, second = (
        figures.save(figures.tracks(path()), tmp_path / f"{name}{kind}").read_bytes() for name in "ab"
    )
    assert first == second
    assert len(first) > 1000


def moment(**changes):
    x = np.array([(0.0, 0.0, 0.003), (0.019, 0.0, 0.003), (0.01, 0.0, 0.005)])
    bed = np.stack([(np.arange(10) + 0.5) * D, np.zeros(10), np.full(10, D / 2)], axis=1)
    what = {
        "t": 0.5,
        "grains": np.arange(3),
        "x": x,
        "d": np.full(3, D),
        "speed": np.array([0.0, 0.1, 0.2]),
        "spin": np.array([-5.0, 0.0, 100.0]),
        "bed_x": bed,
        "bed_d": np.full(10, D),
        "plane_point": np.array([[0.0, 0.0, 0.0]]),
        "plane_normal": np.array([[0.6, 0.0, 0.8]]),
        "period": float("inf"),
    }
    return Snapshot(**(what | changes))


def circles(figure):
    return [one for one in figure.axes[0].collections if isinstance(one, EllipseCollection)]


@pytest.mark.parametrize("colour", ["speed", "spin", "none"])
def test_a_snapshot_is_true_to_scale_in_centimetres(colour):
    figure = figures.snapshot(moment(), colour)
    figure.canvas.draw()
    axes = figure.axes[0]
    assert axes.get_aspect() == 1.0
    assert axes.get_xlabel().endswith("(cm)")
    assert axes.get_ylabel() == "$z$ above datum  (cm)"
    assert [len(one.get_offsets()) for one in circles(figure)] == [10, 3]
    assert circles(figure)[1].get_widths() == pytest.approx([100 * D] * 3)
    assert len(axes.patches) == 1
    assert len(axes.child_axes) == (0 if colour == "none" else 1)


def test_grains_across_a_periodic_side_are_drawn_at_both_ends():
    figure = figures.snapshot(moment(period=10 * D), "none")
    assert figure.axes[0].get_xlim() == pytest.approx((0.0, 100 * 10 * D))
    assert len(circles(figure)[1].get_offsets()) == 4


def test_the_surface_of_the_water_is_in_the_picture():
    dry, wet = figures.snapshot(moment(), "none"), figures.snapshot(moment(surface=0.02), "none")
    assert dry.axes[0].get_ylim()[1] < 2.0 < wet.axes[0].get_ylim()[1]
    assert any(2.0 in np.asarray(line.get_ydata()) for line in wet.axes[0].lines)


def test_the_nearest_row_is_drawn_last():
    rows = moment(x=np.array([(0.0, 0.002, 0.003), (0.0, 0.0, 0.003), (0.0, 0.001, 0.003)]))
    figure = figures.snapshot(rows)
    colours = circles(figure)[1].get_facecolors()
    alone = figures.snapshot(moment(), "speed")
    assert colours[-1] == pytest.approx(circles(alone)[1].get_facecolors()[1])


def surface_of(**changes):
    what = {
        "t": 0.5,
        "side": "right",
        "x": np.array([0.0, 0.01, 0.019]),
        "z": np.array([0.006, 0.005, 0.004]),
        "fit": (0.15, 0.85),
        "inside": np.array([False, True, True]),
        "angle": 0.3,
        "error": 0.01,
        "line": np.array([[0.019, 0.004], [0.01, 0.005]]),
        "angles": {"upper half": 0.2, "lower half": 0.4},
        "spread": 0.2,
        "flags": (),
        "floor": 0.002,
        "crest": 0.006,
        "toe": 0.02,
        "start": 0.01,
        "run_out": 0.01,
        "grains": np.array([0, 1]),
        "away": 1,
        "speed": 0.0,
        "surface_speed": 0.0,
        "still": 0.001,
        "moving": 0.0,
    }
    return HeapSurface(**(what | changes))


def test_a_fitted_slope_is_written_with_its_error_and_its_range():
    figure = figures.surface(moment(), surface_of())
    figure.canvas.draw()
    words = " ".join(one.get_text() for one in figure.axes[0].texts)
    assert "17.2° ± 0.6°" in words
    assert "11.5° to 22.9°" in words


def test_a_heap_without_a_slope_says_so():
    wall = surface_of(
        angle=np.nan, flags=("stands like a wall: steeper than 60 deg",), line=np.full((2, 2), np.nan)
    )
    figure = figures.surface(moment(), wall)
    figure.canvas.draw()
    assert any("stands like a wall" in one.get_text() for one in figure.axes[0].texts)


def test_vibration_is_drawn_per_window_and_as_a_share_at_each_threshold():
    n = 20
    end = 0.01 * np.arange(1, n + 1)
    moved = np.outer(np.exp(-np.arange(n)), [1e-4, 2e-4])
    found = Vibration(
        np.array([3, 7]),
        np.full(2, D),
        D,
        end - 0.01,
        end,
        0.01,
        np.full(n, 11),
        -moved,
        moved,
        moved,
        0 * moved,
    )
    figure = figures.vibration(found, [7, 3])
    figure.canvas.draw()
    above, below = figure.axes
    assert [line.get_label() for line in above.lines] == ["grain 7", "grain 3"]
    assert above.lines[0].get_ydata() == pytest.approx(-100 * moved[:, 1])
    assert "0.01 s" in above.get_ylabel()
    assert "2 µm" in " ".join(text.get_text() for text in below.get_legend().get_texts())


def test_a_high_path_fits_on_a_page_with_the_id_of_its_grain():
    z = np.linspace(0.1, 0.0, 80)[:, None]
    bed, none = np.array([0.0]), np.zeros(0)
    drop = Tracks(
        (4,), np.linspace(0, 0.3, 80), 0 * z, z, np.array([D]), bed, bed, bed + D, none, none, none, math.inf
    )
    figure = figures.tracks(drop, around=moment(grains=np.array([4])))
    figure.canvas.draw()
    assert figure.get_size_inches()[1] < 6.0
    assert (
        figure.axes[0].get_title(loc="left")
        == "grain 4, $t$ = 0 to 0.3 s, its outline at equal distances along the path"
    )
    assert len(figure.axes[0].patches) == 1


@pytest.mark.parametrize("name", ["rise", "length"])
def test_the_dashed_line_of_hops_is_the_mean_and_the_legend_says_so(name):
    rows = np.zeros(4, [("rise", "f8"), ("length", "f8")])
    rows["rise"], rows["length"] = D * np.array([1, 2, 3, 6]), D * np.array([10, 20, 30, 60])
    figure = figures.hops({"run": SimpleNamespace(hops=rows)}, D)
    panel = figure.axes[["rise", "length"].index(name)]
    (mean,) = (line for line in panel.lines if line.get_linestyle() == "--")
    assert mean.get_xdata()[0] == pytest.approx(rows[name].mean() / D)
    assert [text.get_text() for text in figure.axes[0].get_legend().get_texts()] == [
        "run (4 hops, dashed: mean)"
    ]


@pytest.mark.parametrize(("added", "named"), [(1.0, False), (1.09, True)])
def test_contact_times_name_added_mass_only_under_water(added, named):
    times = ContactTimes(eq_8=1e-4, added=added * 1e-4, damped=1.02e-4)
    found = SimpleNamespace(contact_time=np.array([0.9e-4, 1.0e-4]), times=times)
    figure = figures.contact_times(found)
    words = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert any("added mass" in one for one in words) is named
    assert any("dashpot" in one for one in words)
    if not named:
        assert "Eq. (8) with dashpot 1.020" in words


def test_contact_times_are_drawn_by_partner():
    from ryusa.measure import collisions

    events = np.zeros(4, EVENT)
    events["j"] = [1, 2, 2, 3]
    events["t_end"] = events["t_part"] = [1e-4, 1.1e-4, 3e-3, 2e-4]
    events["closing_begin"] = 0.1
    scene = two_grains()
    run = SimpleNamespace(case={}, scene=scene, contacts=events)
    figure = figures.collision_times(collisions(run), scene)
    figure.canvas.draw()
    labels = figure.axes[0].get_legend_handles_labels()[1]
    assert {"free grain (1)", "fixed grain (2)", "plane (1)"} <= set(labels)


@pytest.mark.parametrize(("count", "named"), [(2, {"wall lid (1)", "wall base (2)"}), (5, {"wall (3)"})])
def test_contact_times_tell_walls_from_planes_and_by_their_names(count, named):
    from ryusa.measure import collisions

    events = np.zeros(4, EVENT)
    events["j"] = [3, 4, 5, 5]  # one contact with the plane; faces are numbered after it
    events["t_end"] = events["t_part"] = 1e-4
    events["closing_begin"] = 0.1
    names = ("lid", "base", *"cde")[:count]
    flat = [rectangle(name, (0, 0, 0), (1, 0, 0), (0, 1, 0)) for name in names]
    scene = with_walls(two_grains(), [replace(one, face=one.face[:1], kind=one.kind[:1]) for one in flat])
    run = SimpleNamespace(case={}, scene=scene, contacts=events)
    labels = figures.collision_times(collisions(run), scene).axes[0].get_legend_handles_labels()[1]
    assert {one for one in labels if "expected" not in one} == {"plane (1)"} | named
    assert len(collisions(run, partner="plane").events) == 1
    assert len(collisions(run, partner="wall").events) == 3


def two_grains():
    one = np.ones(2)
    return Scene(
        d=D * one, m=1e-5 * one, m_added=0 * one, m_weight=1e-5 * one, inertia=1e-12 * one,
        x_fixed=np.zeros((1, 3)), d_fixed=np.array([D]), fixed_active=np.array([True]),
        plane_normal=np.array([[0.0, 0.0, 1.0]]), plane_point=np.zeros((1, 3)), plane_active=np.array([True]),
        contact=ContactLaw(k_n=1.0e4, k_s=3.0e3, mu=0.6, e_n=0.7, e_s=0.7, zeta_n=0.12221), dt=1.0e-6,
    )  # fmt: skip
