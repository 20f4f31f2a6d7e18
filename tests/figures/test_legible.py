"""What makes a picture hard to read, held against several of them: words cut off, numbers of many zeros,
legends over data, panels without anything in them."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text

from ryusa import figures
from ryusa.errors import ResultsError
from ryusa.figures import style
from ryusa.figures.deposit import deposit
from ryusa.figures.front import front
from ryusa.figures.long_section import x_t
from ryusa.figures.passages import passages
from ryusa.figures.plane_shear import plane_shear
from ryusa.figures.shear_zone import shear_zone
from ryusa.measure import Snapshot, Tracks
from ryusa.measure.deposit import Deposit
from ryusa.measure.depth_history import DepthHistory
from ryusa.measure.energy import Energy
from ryusa.measure.front import Front
from ryusa.model.tally import GIFTS, HELD, LOSSES
from ryusa.results.label import run_label

T = np.linspace(0.0, 1.0, 6)


def low_paths() -> Tracks:
    """Saltation as flat as that of the paper's fig20: panels a sixth of an inch high."""
    x = np.linspace(0.0, 0.3, 200)
    return Tracks(
        grains=(0,), t=np.linspace(0.0, 1.0, 200), x=x[:, None],
        z=(0.003 + 0.004 * np.abs(np.sin(60 * x)))[:, None], d=np.array([0.002]),
        bed_x=(np.arange(20) + 0.5) * 0.002, bed_z=np.full(20, 0.001), bed_d=np.full(20, 0.002),
        loose_x=np.zeros(0), loose_z=np.zeros(0), loose_d=np.zeros(0), period=0.04,
    )  # fmt: skip


def account() -> Energy:
    """Every term of the account, so that the legend is as long as it can be."""
    one = 1.0e-6 * (1.0 + T)
    lost = {term.name.lower(): one for term in LOSSES}
    given = {term.name.lower(): one for term in GIFTS}
    return Energy(T, dict.fromkeys(HELD, one), lost, given, 0.0, 1.0e-12 * T)


def history(**changes: object) -> DepthHistory:
    """A row over time: fast water upstream of a dam, slow water downstream, and still grains."""
    x = np.arange(20) + 0.5
    froude = np.where(x < 8.0, 2.0, 0.5) * np.ones((6, 1))
    froude[:, 12] = 1.5  # over the dam
    zero = np.zeros(froude.shape)
    what = {
        "t": T, "x": x, "depth": zero + 0.1, "discharge": zero, "froude": froude,
        "dams": (("weir", 12.0, 13.0),), "bed": zero, "volume": zero, "solid_discharge": zero, "grains": True,
    }  # fmt: skip
    return DepthHistory(**(what | changes))  # pyright: ignore[reportArgumentType]


PICTURES = {
    "low paths side by side": lambda: figures.tracks_side_by_side({"a": low_paths(), "b": low_paths()}, 0.3),
    "low paths": lambda: figures.tracks(low_paths()),
    "energy": lambda: figures.energy(account()),
    "x_t": lambda: x_t(history()),
}


def words_of(figure: Figure) -> list[tuple[str, Any]]:
    """Words that are seen, without the numbers of the axes, with their boxes in pixels."""
    figure.canvas.draw()
    numbers = {
        label
        for axes in figure.axes
        for axis in (axes.xaxis, axes.yaxis)
        for tick in axis.get_major_ticks()
        for label in (tick.label1, tick.label2)
    }
    return [
        (one.get_text(), one.get_window_extent())
        for one in figure.findobj(Text)
        if one not in numbers and one.get_visible() and one.get_text().strip()
    ]


@pytest.mark.parametrize("name", PICTURES)
def test_no_words_are_cut_at_the_edge(name: str) -> None:
    figure = PICTURES[name]()
    for text, box in words_of(figure):
        inside = box.x0 > -1.0 and box.y0 > -1.0 and box.x1 < figure.bbox.x1 + 1.0
        assert inside and box.y1 < figure.bbox.y1 + 1.0, text


def test_the_account_keeps_its_width_beside_a_long_legend() -> None:
    figure = figures.energy(account())
    figure.canvas.draw()
    for axes in figure.axes:
        legend = axes.get_legend().get_window_extent()
        assert axes.get_window_extent().width > 0.5 * figure.bbox.width
        assert legend.x0 > axes.get_window_extent().x1
        assert legend.x1 < figure.bbox.x1


@pytest.mark.parametrize(
    ("largest", "numbers", "unit"),
    [
        (2.4e-4, "2.0", r"($10^{-4}$ kg)"),
        (0.4, "0.20", "(kg)"),
        (0.011, "1.0", r"($10^{-2}$ kg)"),
        (3.0e6, "3.0", r"($10^{6}$ kg)"),
    ],
)
def test_small_and_large_numbers_have_their_power_of_ten_at_the_unit(
    largest: float, numbers: str, unit: str
) -> None:
    @style.house
    def drawn() -> Figure:
        figure, (axes,) = style.new()
        axes.plot(T, largest * T)
        axes.set_ylabel("mass  (kg)")
        axes.set_ylim(0.0, largest)
        return figure

    figure = drawn()
    figure.canvas.draw()
    (axes,) = figure.axes
    assert axes.get_ylabel() == f"mass  {unit}"
    assert numbers in [one.get_text() for one in axes.get_yticklabels()]
    assert axes.get_xlabel() == ""
    assert axes.yaxis.get_offset_text().get_visible() == (largest == 0.4)


def test_a_number_without_a_unit_gets_the_power_alone() -> None:
    @style.house
    def drawn() -> Figure:
        figure, (axes,) = style.new()
        axes.plot(T, -5e-4 * T)
        axes.set_ylabel("rate  $q_*$  (–)")
        return figure

    assert drawn().axes[0].get_ylabel() == r"rate  $q_*$  ($10^{-4}$)"


def test_the_line_of_froude_number_1_leaves_out_dams_and_shores() -> None:
    dry = history().froude
    dry[:, 3] = np.nan
    figure = x_t(history(froude=dry), "depth")
    lines = [one for one in figure.axes[0].collections if hasattr(one, "levels")]
    at = np.concatenate([path.vertices[:, 0] for path in lines[0].get_paths()])
    assert np.all((at > 7.5) & (at < 8.5))


def test_panels_without_a_signal_are_left_out_and_named() -> None:
    still = x_t(history())
    assert [one.get_xlabel() for one in still.axes if one.get_xlabel().startswith(("$x$", "distance"))] == [
        "distance along the row  $x$  (m)"
    ]
    assert style.notes(still) == ("zero throughout and not drawn: rise of the bed, grains $q_s$",)
    moved = x_t(history(bed=np.cumsum(np.full((6, 20), 0.01), axis=0)))
    assert style.notes(moved) == ("zero throughout and not drawn: grains $q_s$",)


def stored(volume: float, slope: float) -> Deposit:
    zero = np.zeros(6)
    return SimpleNamespace(  # pyright: ignore[reportReturnType]
        t=T, brought=zero, passed=zero, stored=zero + volume, slope=zero + slope, slope_error=zero
    )


def test_a_history_of_one_moment_is_refused_in_words() -> None:
    one = history()
    with pytest.raises(ResultsError, match="1 frames: a picture over time needs two or more"):
        x_t(DepthHistory(**(one.__dict__ | {"t": one.t[:1]})))


@pytest.mark.parametrize("mu", [0.4, 0.8])
def test_the_friction_of_a_sheared_layer_lies_in_its_panel(mu: float) -> None:
    class Layer(SimpleNamespace):
        def __getitem__(self, name: str) -> SimpleNamespace:
            return SimpleNamespace(error=0.01)

    z, layers = np.linspace(0.0, 0.02, 5), SimpleNamespace(value=np.ones(5), error=np.full(5, 0.1))
    found = Layer(
        z=z, core=(0.005, 0.015), phi=layers, v_x=layers, at_datum=0.0, shear_rate=50.0, speed=1.0,
        inertial=0.1, mu=mu,
    )  # fmt: skip
    low, high = plane_shear(found).axes[2].get_ylim()  # pyright: ignore[reportArgumentType]
    assert low < mu < high


def test_the_legends_of_a_shear_zone_lie_over_no_point() -> None:
    r = np.linspace(0.0, 0.07, 15)
    found = SimpleNamespace(
        r=r, turning=SimpleNamespace(value=0.8 * (r < 0.04), error=0.0 * r), centre=0.04, width=0.02,
        share=0.8, r_s=0.05, z=r[:4], centres=r[5:9], widths=r[3:7], height=0.02,
    )  # fmt: skip
    figure = shear_zone(found)  # pyright: ignore[reportArgumentType]
    figure.canvas.draw()
    for axes in figure.axes:
        legend = axes.get_legend().get_window_extent()  # pyright: ignore[reportOptionalMemberAccess]
        assert legend.y0 >= axes.get_window_extent().y1
        assert legend.x1 <= figure.bbox.x1


def test_a_deposit_draws_what_there_is_and_says_what_there_is_not() -> None:
    assert len(deposit(stored(0.01, 0.1)).axes) == 2
    assert style.notes(deposit(stored(0.0, 0.1))) == ("no grains came, went or were stored",)
    assert style.notes(deposit(stored(0.01, np.nan))) == ("no bed that has a slope",)
    with pytest.raises(ResultsError, match="no bed that has a slope"):
        deposit(stored(0.0, np.nan))


def test_a_front_of_grains_that_stay_is_refused_in_words() -> None:
    nowhere = np.full(6, np.nan)
    with pytest.raises(ResultsError, match="no grain has moved"):
        front(Front(T, nowhere, nowhere, np.zeros(6), averages=None))  # pyright: ignore[reportArgumentType]


def test_a_leave_of_few_grams_is_read_without_counting_zeros() -> None:
    one = SimpleNamespace(label="out by outlet", t=np.array([0.5]), m=np.array([2.4e-4]), way=-1,
                          owed_n=np.zeros(0))  # fmt: skip
    found = SimpleNamespace(gates=(one,), window=(0.0, 1.0))
    axes = passages(found).axes[0]  # pyright: ignore[reportArgumentType]
    assert axes.get_ylabel() == r"mass that passed  ($10^{-4}$ kg)"


def test_grains_of_a_row_stand_in_its_water_with_its_weir_and_its_inclined_axis() -> None:
    x = np.arange(10) * 0.01 + 0.005
    floor = np.where(x > 0.07, 0.03, 0.0)
    row = np.column_stack([x, np.zeros(10), floor, np.full(10, 0.05)])
    seen = Snapshot(
        t=0.0, grains=np.arange(2), x=np.array([[0.01, 0.0, 0.002], [0.09, 0.0, 0.032]]), d=np.full(2, 4e-3),
        speed=np.zeros(2), spin=np.zeros(2), bed_x=np.zeros((0, 3)), bed_d=np.zeros(0),
        plane_point=np.zeros((0, 3)), plane_normal=np.zeros((0, 3)), period=np.inf, along_row=row,
        fall=np.radians(9.0),
    )  # fmt: skip
    axes = figures.snapshot(seen).axes[0]
    (surface,) = (one for one in axes.lines if len(one.get_xdata()) == 12)
    assert surface.get_ydata() == pytest.approx(5.0)
    assert surface.get_xdata()[[0, -1]] == pytest.approx([0.0, 10.0])  # to the ends of the row
    assert axes.get_ylim()[1] > 5.0  # centimetres: the picture holds water and weir
    assert [max(one.get_xy()[:, 1]) for one in axes.patches if len(one.get_xy()) == 5] == pytest.approx(
        [3.0] * 3
    )
    assert axes.get_ylabel() == "$z$ normal to $x$  (cm)"
    assert axes.get_xlabel() == "$x$, falls by 9°  (cm)"
    level = figures.snapshot(Snapshot(**(seen.__dict__ | {"fall": 0.0}))).axes[0]
    assert level.get_ylabel() == "$z$ above datum  (cm)"


@pytest.mark.parametrize(("d", "shown"), [(4e-3, True), (1e-4, False)])
def test_a_weir_beyond_the_grains_is_shown_unless_they_would_be_dots(d: float, shown: bool) -> None:
    x = np.arange(100) * 0.01 + 0.005
    floor = np.where((x > 0.7) & (x < 0.75), 0.0, -0.1 * x)
    row = np.column_stack([x, -0.1 * x, floor, -0.1 * x + 0.02])
    seen = Snapshot(
        t=0.0, grains=np.arange(1), x=np.array([[0.1, 0.0, 0.0]]), d=np.array([d]), speed=np.zeros(1),
        spin=np.zeros(1), bed_x=np.zeros((0, 3)), bed_d=np.zeros(0), plane_point=np.zeros((0, 3)),
        plane_normal=np.zeros((0, 3)), period=np.inf, along_row=row,
    )  # fmt: skip
    axes = figures.snapshot(seen).axes[0]
    assert bool(axes.get_xlim()[1] > 75.0) is shown  # centimetres: the weir from crest to toe
    assert bool(axes.get_ylim()[0] < -7.5) is shown
    assert axes.get_xlim()[1] < 80.0


@pytest.mark.parametrize(
    ("folder", "name"),
    [
        ("fig20/100Ncm-1a2b3c4d", "100Ncm"),
        ("saltation", "saltation"),
        ("runs/0011aaff", "run"),
        ("heap-20250101", "heap-20250101"),
    ],
)
def test_a_legend_does_not_show_the_digits_that_tell_runs_of_a_sweep_apart(
    tmp_path, folder: str, name: str
) -> None:
    assert run_label(SimpleNamespace(folder=tmp_path / folder)) == name


@pytest.mark.parametrize(
    ("folder", "name"),
    [
        (
            "friction_angle-30deg_restitution-0.5_seed-1-1a2b3c4d",
            "friction angle 30 deg, restitution 0.5, seed 1",
        ),
        ("grains.density-2650kgm3_seed-1-37324363", "grains.density 2650 kg/m3, seed 1"),
        ("friction_angle-30deg_grains.density-2650kgm3_water.density-10-1a2b3c4d",
         "friction angle 30 deg, grains.density 2650 kg/m3, water.density 1000 kg/m3, seed 1"),
        ("friction_angle-30deg_of_mine", "friction_angle-30deg_of_mine"),
    ],
)  # fmt: skip
def test_a_legend_says_in_words_what_varies_in_a_sweep(tmp_path, folder: str, name: str) -> None:
    overrides = {
        "contact.friction_angle": "30 deg", "contact.restitution": "0.5", "grains.density": "2650 kg/m3",
        "water.density": "1000 kg/m3", "seed": "1", "stop.time": "'1 s'",
    }  # fmt: skip
    run = SimpleNamespace(folder=tmp_path / folder, provenance={"overrides": overrides})
    assert run_label(run) == name
