"""Films, read back from their files."""

from importlib.util import find_spec

import matplotlib as mpl
import numpy as np
import pytest
from PIL import Image, ImageSequence
from typer.testing import CliRunner

from ryusa.cli import app
from ryusa.errors import CaseError
from ryusa.view import film_file, picture
from ryusa.view.colouring import COLOURINGS, value_range
from ryusa.view.film import _colouring, _look, film
from ryusa.view.margins import inner_size
from ryusa.view.picture import Painter
from ryusa.view.raster import BACKGROUND, CHOSEN

SIZE = (480, 270)
HEAD, FOOT = 35, 70  # pixels of the margins at 960 x 540


def need_pyav_for(suffix):
    if suffix == ".mp4":
        pytest.importorskip("av", reason="PyAV is an extra")


def pictures(path):
    if path.suffix == ".mp4":
        import av

        with av.open(str(path)) as film:
            return [frame.to_image() for frame in film.decode(video=0)]
    with Image.open(path) as seen:
        return [one.convert("RGB") for one in ImageSequence.Iterator(seen)]


def durations(path):
    """Of each picture [ms]."""
    with Image.open(path) as seen:
        found = []
        for k in range(seen.n_frames):
            seen.seek(k)
            seen.load()
            found.append(seen.info["duration"])
        return found


def discs(picture):
    """Column, row and size of each patch of the grains' picture that is neither background nor line."""
    from scipy.ndimage import label

    seen = np.asarray(picture).astype(int)
    apart = (np.abs(seen - BACKGROUND).sum(axis=2) > 60) & (np.ptp(seen, axis=2) > 40)
    patches, count = label(apart)
    found = [np.nonzero(patches == k) for k in range(1, count + 1)]
    return sorted((columns.mean() + 0.5, rows.mean() + 0.5, len(rows)) for rows, columns in found)


def painter_of(results, view="side", colour="speed", follow=None):
    """What draws the grains of a film at 960 x 540."""
    inner = inner_size((960, 540))
    look, _ = _look(
        results, np.arange(len(results.frames)), view, _colouring(colour), inner[0] / inner[1], follow
    )
    return Painter(results, look, *inner)


def expected(painter, x, d):
    """Columns and rows of centres, and radii, in pixels."""
    high = painter.canvas.height
    places = painter.look.camera.project(x, painter.canvas.width, high)
    return places[:, :2], 0.5 * d * 0.5 * high / painter.look.camera.half


@pytest.mark.parametrize("suffix", film_file.SUFFIXES)
def test_a_film_has_the_pictures_the_size_and_the_length_that_were_asked_for(three, tmp_path, suffix):
    need_pyav_for(suffix)
    path = tmp_path / f"film{suffix}"
    made = film(three, path, frames=8, fps=20.0, size=SIZE)
    seen = pictures(path)
    assert len(seen) == len(made.times) == 8
    assert {one.size for one in seen} == {SIZE}
    assert made.seconds == pytest.approx(0.4)
    if suffix == ".mp4":
        import av

        with av.open(str(path)) as read:
            assert read.streams.video[0].average_rate == 20
    elif suffix == ".avif":
        pass  # Pillow reads no durations of it
    else:
        assert durations(path) == [50] * 8
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("suffix", film_file.SUFFIXES)
def test_a_file_has_the_colours_that_were_drawn(three, tmp_path, suffix, monkeypatch):
    need_pyav_for(suffix)
    drawn = []

    def kept(path, draw, count, fps):
        drawn.append(np.asarray(draw(1)).astype(int))
        film_file.write(path, draw, count, fps)

    monkeypatch.setattr("ryusa.view.film.write", kept)
    path = tmp_path / f"film{suffix}"
    film(three, path, frames=3, size=(960, 540), view="side", colour="size")
    apart = np.abs(np.asarray(pictures(path)[1]).astype(int) - drawn[0])
    assert apart.mean() < 4.0
    for column, row, _ in discs(drawn[0][HEAD:-FOOT]):
        assert apart[HEAD + round(row), round(column)].max() <= 12


def test_a_rate_of_no_whole_milliseconds_keeps_the_length(three, tmp_path):
    for suffix, unit in ((".webp", 1), (".gif", 10)):
        path = tmp_path / f"film{suffix}"
        film(three, path, frames=9, fps=30.0, size=SIZE)
        assert sum(durations(path)) == pytest.approx(300, abs=unit)
        assert max(durations(path)) - min(durations(path)) <= unit


@pytest.mark.parametrize("t", [0.0, 0.033, 0.0175, 0.1])
def test_grains_are_where_they_were_and_as_large_as_they_are(three, flight, t, monkeypatch):
    monkeypatch.setattr(picture, "edges_of", lambda low, high: [])  # they would cut grains in two
    painter = painter_of(three, colour="size")  # colours far from grey
    x = flight.x + flight.v * t  # free flight: straight lines between frames are exact
    x[:, :2] %= flight.period
    places, radii = expected(painter, x, flight.d)
    order = np.argsort(places[:, 0])
    found = discs(painter.at(t))
    assert len(found) == 3  # no streak where a grain crosses a side
    for (column, row, size), g in zip(found, order, strict=True):
        assert (column, row) == pytest.approx(places[g], abs=1.0)
        assert np.sqrt(size / np.pi) == pytest.approx(radii[g], abs=1.0)


def test_a_grain_has_the_colour_of_its_speed(three, flight):
    painter = painter_of(three)
    one = COLOURINGS[0]
    low, high = value_range(one, np.stack([one.values(three, k) for k in range(11)]), three.scene)
    assert (painter.look.low, painter.look.high) == (low, high)
    seen = painter.at(0.0).astype(float)
    places, _ = expected(painter, flight.x, flight.d)
    for g, speed in enumerate([0.1, 0.2, 0.1]):
        column, row = places[g].astype(int)
        own = 255.0 * np.array(mpl.colormaps[one.colours](min(speed / high, 1.0))[:3])
        shade = seen[row, column] / own.clip(1.0)
        bright = own > 30.0
        assert np.ptp(shade[bright]) < 0.06
        assert shade[bright].mean() == pytest.approx(
            0.5 + 0.5 * 0.55 / np.linalg.norm([0.35, 0.75, 0.55]), abs=0.05
        )


@pytest.mark.parametrize("view", ["oblique", "side", "top"])
def test_the_grain_that_is_followed_stays_in_the_middle(three, view):
    painter = painter_of(three, view, follow=1)
    wide, high = painter.canvas.width, painter.canvas.height
    for t in (0.0, 0.015, 0.023, 0.1):
        ring = (painter.at(t).astype(int) == CHOSEN).all(axis=2)
        rows, columns = np.nonzero(ring)
        assert len(rows) > 50
        assert 0.5 * (columns.min() + columns.max() + 1) == pytest.approx(0.5 * wide, abs=1.5)
        assert 0.5 * (rows.min() + rows.max() + 1) == pytest.approx(0.5 * high, abs=1.5)


def test_around_a_followed_grain_neighbours_keep_their_places_across_a_side(three, flight):
    painter = painter_of(three, colour="size", follow=1)
    metre = 0.5 * painter.canvas.height / painter.look.camera.half
    t = 0.03  # grain 1 has crossed the side of the period
    x = flight.x + flight.v * t
    away = x - x[1]
    away[:, :2] -= flight.period * np.round(away[:, :2] / flight.period)
    found = discs(painter.at(t))
    for g in (0, 2):
        column = 0.5 * painter.canvas.width + metre * away[g, 0]
        row = 0.5 * painter.canvas.height - metre * away[g, 2]
        if 0.0 < column < painter.canvas.width and 0.0 < row < painter.canvas.height:
            assert any(abs(column - a) < 3.0 and abs(row - b) < 3.0 for a, b, _ in found)


@pytest.mark.parametrize("follow", [None, 2])
def test_a_lid_that_is_dragged_on_is_seen_over_the_whole_period(dragged, flight, follow):
    painter = painter_of(dragged, follow=follow)
    metre = 0.5 * painter.canvas.height / painter.look.camera.half
    seen = painter.at(0.05).astype(int)
    painter._add_walls = lambda *given: None
    lid = np.abs(seen - painter.at(0.05)).sum(axis=2) > 60
    assert lid.sum(axis=1).max() == pytest.approx(flight.period * metre, abs=3.0)
    assert lid.any(axis=0).sum() == pytest.approx(flight.period * metre, abs=3.0)  # nothing beside the period


def test_scale_and_box_hold_the_whole_film(saltation):
    painter = painter_of(saltation)
    low, high = painter.look.box
    x = saltation.frames.x_wrapped[:]
    r = 0.5 * saltation.scene.d[:, None]
    assert ((x - r)[..., 2] >= low[2]).all()
    assert ((x + r)[..., 2] <= high[2]).all()
    corners = painter.look.camera.project(np.array([low, high]), 960, painter.canvas.height)
    assert (corners[:, :2] >= 0).all()
    assert (corners[:, 0] <= 960).all()
    assert (corners[:, 1] <= painter.canvas.height).all()


def test_a_film_made_twice_has_the_same_bytes(saltation, tmp_path):
    for suffix in film_file.SUFFIXES:
        if suffix == ".mp4" and find_spec("av") is None:
            continue
        one, other = (tmp_path / f"{name}{suffix}" for name in "ab")
        for path in (one, other):
            film(saltation, path, frames=4, size=SIZE, view="oblique")
        if suffix == ".avif":  # which holds the time when it was made
            assert (np.stack(pictures(one)) == np.stack(pictures(other))).all()
        else:
            assert one.read_bytes() == other.read_bytes()


def test_the_speed_says_how_times_follow_each_other(three, tmp_path):
    made = film(three, tmp_path / "film.gif", speed=0.05, fps=20.0, size=SIZE)
    assert np.diff(made.times) == pytest.approx(0.05 / 20.0)
    assert made.times[0] == 0.0
    assert 0.0 <= three.frames.t[-1] - made.times[-1] <= 0.05 / 20.0
    usual = film(three, tmp_path / "film.gif", fps=5.0, size=SIZE)
    assert usual.speed == pytest.approx(0.01)
    assert usual.seconds == pytest.approx(10.0, abs=0.3)


def test_a_window_shows_nothing_beyond_it(three, tmp_path):
    made = film(three, tmp_path / "film.gif", begin=0.035, end=0.075, frames=3, size=SIZE)
    assert made.times == pytest.approx([0.04, 0.055, 0.07], abs=3e-6)  # a frame comes with a step


def test_nothing_is_left_of_a_film_that_is_broken_off(three, tmp_path):
    path = tmp_path / "film.webp"
    path.write_bytes(b"before")

    def stop(share):
        if share > 0.5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        film(three, path, frames=6, size=SIZE, progress=stop)
    assert [one.name for one in tmp_path.iterdir()] == ["film.webp"]
    assert path.read_bytes() == b"before"


def test_the_progress_grows_to_one(three, tmp_path):
    shares = []
    film(three, tmp_path / "film.webp", frames=5, size=SIZE, progress=shares.append)
    assert shares == pytest.approx([0.2, 0.4, 0.6, 0.8, 1.0])


def test_a_title_is_shown_as_text_and_cut_to_its_room(three, tmp_path, monkeypatch):
    monkeypatch.setitem(three.case, "title", "$\\frac{x\n" + "very long " * 40)
    film(three, tmp_path / "film.gif", frames=2, size=SIZE)
    seen = np.asarray(pictures(tmp_path / "film.gif")[0]).astype(int)[:HEAD]
    assert (np.abs(seen - BACKGROUND).sum(axis=2) > 200)[:, :200].any()


def test_without_pyav_mp4_says_what_to_install(three, tmp_path, monkeypatch):
    monkeypatch.setattr(film_file, "find_spec", lambda name: None)
    with pytest.raises(CaseError, match=r"pip install 'ryusa\[film\]'.*\.webp"):
        film(three, tmp_path / "film.mp4")


def test_a_pillow_without_avif_names_what_it_can_write(three, tmp_path, monkeypatch):
    monkeypatch.setattr(film_file.features, "check", lambda name: name != "avif")
    with pytest.raises(CaseError, match=r"does not write \.avif here; it writes \.webp, \.gif"):
        film(three, tmp_path / "film.avif")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["-o", "film.mov"], "--output = 'film.mov': must end in .webp, .avif, .gif or .mp4"),
        (
            ["--view", "sde"],
            "--view = 'sde': must be one of oblique, side, top, long_section, flow_field. Did you "
            "mean 'side'?",
        ),
        (["--colour", "sped"], "Did you mean 'speed'?"),
        (["--size", "1280"], "--size = '1280': must be width and height in pixels, such as 1280x720"),
        (["--size", "64x64"], "--size = '64x64': must be 480x270 to 7680x4320"),
        (["--size", "961x541", "-o", "film.mp4"], "--size = '961x541': must be even"),
        (["--follow", "3"], "--follow = 3: must be a free grain, 0 to 2"),
        (["--frames", "1"], "--frames = 1: must be 2 to 10000"),
        (["--frames", "9", "--speed", "1"], "--frames = 9: must be left out where a speed is given"),
        (["--speed", "0"], "--speed = 0.0: must be 0.00025 to 2.5"),
        (["--fps", "0"], "--fps = 0.0: must be 1 to 60"),
        (["--begin", "20"], "--begin = '20': missing unit"),
        (["--begin", "0.095 s"], "1 frames from 0.095 to inf s, and a film needs two or more"),
        (["--frames", "9000", "-o", "film.gif"], "--frames = 9000: must be at most 2170 for a GIF"),
    ],
)
def test_what_cannot_be_done_is_refused_with_its_reason(three, words, said):
    need_pyav_for("".join(words)[-4:])
    result = CliRunner().invoke(app, ["film", str(three.folder), *words])
    assert result.exit_code == 2
    assert said in result.stderr


def test_the_command_writes_beside_the_run_and_says_what(three):
    result = CliRunner().invoke(app, ["film", str(three.folder), "--frames", "3", "--size", "480x270", "-q"])
    assert result.exit_code == 0, result.output
    path = three.folder / "film.webp"
    assert f"wrote {path}" in result.stdout
    assert "3 pictures of 11 recorded frames, 0.12 s, 1.25 x real time" in result.stdout
    assert len(pictures(path)) == 3
    path.unlink()


def test_each_picture_has_the_surface_of_its_own_frame(three, monkeypatch):
    """Beside planes too: the surface along a row once was that of one frame in all pictures of a film."""
    seen = []
    monkeypatch.setattr(Painter, "_add_row", lambda self, k, share, *rest: seen.append((k, share)))
    painter, t = painter_of(three), np.asarray(three.frames.t)
    for one in (*t, 0.25 * t[3] + 0.75 * t[4]):
        painter.at(float(one))
    assert [k for k, _ in seen] == [*range(len(t)), 3]
    assert [share for _, share in seen] == pytest.approx([*np.zeros(len(t)), 0.75], abs=1e-6)
