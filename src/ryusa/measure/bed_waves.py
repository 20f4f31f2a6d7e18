"""Waves of the bed of a periodic row: their length, height and speed, and the surface over them."""

import math
from dataclasses import dataclass

import numpy as np

from ryusa.errors import ResultsError
from ryusa.measure._run import Floats, Run, settle_time
from ryusa.measure.long_section import bed_line, row_of
from ryusa.measure.table import lines

FEWEST = 6  # segments that a wave needs to be told from its neighbours


@dataclass(frozen=True, repr=False)
class BedWaves:
    """Waves that fit into the period, from the longest on; arrays of shape (n_wave,).

    Attributes
    ----------
    length : wave length [m].
    bed, surface : height from trough to crest of bed and of surface, of the mean square over the frames [m].
    gain : height of the part of the surface that goes with the bed, over that of the bed [-]. In potential
        flow it is 1/(cosh kh - sinh kh/(Fr**2 kh)) (Kennedy 1963).
    phase : by how much of a wave a crest of that part lies downstream of that of the bed [deg].
    celerity : speed of the waves of the bed, downstream above 0 [m/s].
    steady : share of the bed's waves that keep this speed from frame to frame [-]; 0 where they come and go.
    """

    length: Floats
    bed: Floats
    surface: Floats
    gain: Floats
    phase: Floats
    celerity: Floats
    steady: Floats

    def rows(self) -> list[dict[str, object]]:
        """One line for each wave."""
        columns = {
            "length_m": self.length, "bed_m": self.bed, "surface_m": self.surface, "gain": self.gain,
            "phase_deg": self.phase, "celerity_m_per_s": self.celerity, "steady": self.steady,
        }  # fmt: skip
        return lines(columns)


def bed_waves(run: Run, begin: float | None = None, end: float = math.inf) -> BedWaves:
    """Waves of the bed of a periodic row of columns, and of the surface over them.

    Parameters
    ----------
    run : with grains in a row without ends.
    begin, end : window [s]; `begin` defaults to the case's `record.settle`.

    Raises
    ------
    ResultsError : no such row, fewer than three frames in the window, or too few segments for a wave.
    """
    found = row_of(run)
    row, first = found.row, settle_time(run) if begin is None else begin
    if not row.periodic or not run.scene.n_grain:
        raise ResultsError("needs grains in a periodic row of columns (water.row without ends)")
    if row.n_segment < FEWEST:
        raise ResultsError(f"{row.n_segment} segments: a wave needs {FEWEST} or more")
    frames = np.flatnonzero((found.t >= first) & (found.t <= end))
    if len(frames) < 3:
        raise ResultsError(f"{len(frames)} frames from {first:g} to {end:g} s: waves need three or more")
    bed = bed_line(run, found, frames, "packed")
    return waves_of(found.t[frames], row.dx, bed, found.surface[frames])


def waves_of(t: Floats, dx: float, bed: Floats, surface: Floats) -> BedWaves:
    """Waves of lines along a period.

    Parameters
    ----------
    t : times [s], shape (n_frame,), evenly spaced.
    dx : length of a segment [m].
    bed, surface : heights [m], shape (n_frame, n_segment).

    Notes
    -----
    Of the complex amplitudes B and S of a wave, gain and phase are those of sum(S conj(B))/sum(|B|**2), and
    the celerity follows from the turn of B between two frames, weighted with |B|**2: a wave must not go on by
    half its length from frame to frame.
    """
    n = bed.shape[1]
    number = np.arange(1, n // FEWEST + 1)
    b, s = (2.0 / n * np.fft.rfft(one, axis=1)[:, number] for one in (bed, surface))
    power = (np.abs(b) ** 2).mean(axis=0)
    joint = (s * b.conj()).mean(axis=0)
    turn = (b[1:] * b[:-1].conj()).sum(axis=0)
    whole = np.abs(b[1:] * b[:-1].conj()).sum(axis=0)
    length = n * dx / number
    with np.errstate(invalid="ignore", divide="ignore"):
        gain, phase, steady = np.abs(joint) / power, -np.degrees(np.angle(joint)), np.abs(turn) / whole
    celerity = -np.angle(turn) / float(np.diff(t).mean()) * length / (2.0 * math.pi)
    return BedWaves(
        length,
        2.0 * np.sqrt(power),
        2.0 * np.sqrt((np.abs(s) ** 2).mean(axis=0)),
        gain,
        phase,
        celerity,
        steady,
    )
