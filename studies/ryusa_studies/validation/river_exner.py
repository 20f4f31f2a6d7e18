"""A wave of a loose bed decays and travels as the transport over even beds says (design/0028)."""

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from ryusa.cases import case_path
from ryusa.figures.comparison import Curve
from ryusa.measure.along_row import grains_along_row
from ryusa.measure.long_section import bed_line, row_of
from ryusa.measure.statistics import standard_errors
from ryusa.model.arrays import Floats
from ryusa.results import Results
from ryusa.study import CaseRun, Finding, Found, Level, Plan, case_run
from ryusa_studies.validation.declared import declared

DECLARED = declared(__file__)

CASE = "bed_wave"
EVEN_LENGTH = 0.12  # of the beds without a wave [m]
EVEN_TIME, EVEN_SETTLE = 24.0, 4.0  # length of their runs, and what is left out of them [s]
EVEN = ((0.75, 1.1), (1.3, 0.916), (1.0, 1.136))  # slope and depth of these over those of the wave [-]
SEGMENT = 0.015  # about the length of a segment: three diameters [m]
CORE = 6e-3, 15e-3  # heights over the lowest cell between which the settled bed is dense [m]


@dataclass(frozen=True)
class Wave:
    """Setting of a run: density and slope give a Shields number of 0.15 and the Froude number."""

    density: str
    stiffness: str
    slope: float
    depth: float  # over the bed [m]
    length: float  # of the wave and the row [m]
    height: float  # from trough to crest [m]
    time: float  # of the run [s]
    seeds: tuple[int, ...]


WAVES = {
    "critical": Wave("1500 kg/m3", "27 N/cm", 0.018, 0.022, 2.0, 0.005, 8.0, (1, 2)),
    "tranquil": Wave("1250 kg/m3", "24 N/cm", 0.009, 0.021, 1.0, 0.004, 5.5, (1,)),
    "rapid": Wave("2050 kg/m3", "35 N/cm", 0.035, 0.023, 1.2, 0.005, 7.0, (1,)),
}


def growth(k: float, diffusion: float, slope: float, depth: float, froude: float) -> complex:
    """Rate sigma at which a small wave of the bed exp(i k x + sigma t) grows [1/s].

    Its decay is -Re(sigma), and it travels downstream at -Im(sigma)/k.

    Parameters
    ----------
    k : wave number [1/m].
    diffusion : K = (dq_s/dS at constant q)/(1 - p) [m2/s].
    slope, depth, froude : of the even flow [-], [m], [-].

    Notes
    -----
    Linear theory with constant discharge, friction slope S (h_0/h)^3 and q_s of that slope alone
    (design/0028): sigma = (3 S/h_0) K k^2/(i k (1 - Fr^2) - 3 S/h_0).
    """
    steep = 3.0 * slope / depth
    return steep * diffusion * k * k / (1j * k * (1.0 - froude**2) - steep)


def fitted(t: Floats, amplitude: np.ndarray) -> tuple[complex, complex]:
    """Amplitude at the first time, and sigma [1/s], of a exp(sigma (t - t[0])) by least squares."""
    start = amplitude[: max(len(t) // 10, 1)].mean()
    logs = np.log(np.abs(amplitude)) + 1j * np.unwrap(np.angle(amplitude))
    first = complex(*(np.polyfit(t, part, 1)[0] for part in (logs.real, logs.imag)))

    def off(given: Floats) -> Floats:
        left = (given[0] + 1j * given[1]) * np.exp((given[2] + 1j * given[3]) * (t - t[0])) - amplitude
        return np.concatenate([left.real, left.imag])

    scale = max(abs(start), 1e-12)
    found = least_squares(
        off, [start.real, start.imag, first.real, first.imag], x_scale=[scale, scale, 1.0, 1.0]
    ).x
    return complex(found[0], found[1]), complex(found[2], found[3])


def transport_slope(even: Sequence[tuple[float, float, float, float]], slope: float, q: float) -> Floats:
    """q_s [m2/s] and its derivative by the slope at constant q [m2/s], with its relative error.

    Parameters
    ----------
    even : slope, discharge and q_s [m2/s] of three even beds, and the relative error of q_s.
    slope, q : where q_s = a S^n q^m is taken [-], [m2/s].
    """
    rows = np.array([[1.0, math.log(s / slope), math.log(one / q)] for s, one, _, _ in even])
    inverse = np.linalg.inv(rows)
    a, n, _ = inverse @ np.log([q_s for _, _, q_s, _ in even])
    error = math.sqrt(float(((inverse[0] + inverse[1] / n) ** 2) @ np.array([e for *_, e in even]) ** 2))
    return np.array([math.exp(a), n * math.exp(a) / slope, error])


def measure(run: Results, one: CaseRun) -> dict[str, Floats]:
    """Flow over a bed, and the amplitude of its first wave after the settling time.

    Returns
    -------
    `t` [s]; parts of the amplitude, `cosine` and `sine` [m], of a wave Re((cosine + i sine) exp(i k x)), and
    `noise`, the rms of the amplitudes of the second and third wave [m]. Means from the settling time on:
    `slope` [-]; `q` and `q_s` of water and grains [m2/s], with the relative `error` of q_s [-]; `depth` [m];
    `froude` [-] of both over that depth; `core`, the concentration of the settled bed [-].
    """
    del one
    found, row = row_of(run), row_of(run).row
    frames = np.flatnonzero(found.t >= float(run.case["record"]["settle"]) - 1e-9)
    t, beds = found.t[frames], bed_line(run, found, frames, "packed")
    phase = 2j * math.pi * row.x / (row.n_segment * row.dx)
    waves = [2.0 * (beds * np.exp(-m * phase)).mean(axis=1) for m in (1, 2, 3)]
    passed = grains_along_row(run, row, frames).passed.mean(axis=1)
    rates = np.diff(passed) / np.diff(t)
    q_s = float((passed[-1] - passed[0]) / (t[-1] - t[0]))
    q = float((found.passed[frames[-1]] - found.passed[frames[0]]).mean() / (t[-1] - t[0]))
    depth = float((found.surface[frames] - beds).mean())
    z = row.column.z - row.column.z_low
    return {
        "t": t, "cosine": waves[0].real, "sine": waves[0].imag,
        "noise": np.array(math.sqrt(float((np.abs(waves[1:]) ** 2).mean()))),
        "slope": np.array(row.column.g_x / row.g_z), "q": np.array(q), "q_s": np.array(q_s),
        "error": np.array(float(standard_errors(rates[:, None])[0]) / q_s), "depth": np.array(depth),
        "froude": np.array((q + q_s) / math.sqrt(row.g_z * depth**3)),
        "core": np.array(float(found.phi[frames][:, :, (z > CORE[0]) & (z < CORE[1])].mean())),
    }  # fmt: skip


def _case(wave: Wave, length: float, **more: str) -> dict[str, str]:
    return {
        "grains.density": f"'{wave.density}'", "contact.stiffness": f"'{wave.stiffness}'",
        "build.length": f"'{length:g} m'", "water.row.segments": str(round(length / SEGMENT)),
        "water.row.bottom": f"[['0 m', '0 m'], ['{length:g} m', '0 m']]",
        **{key.replace("__", "."): value for key, value in more.items()},
    }  # fmt: skip


def _wave(name: str, seed: int) -> CaseRun:
    one = WAVES[name]
    return case_run(
        case_path("validation/bed_wave.toml"),
        _case(
            one, one.length, motion__slope=f"{one.slope:g}", water__depth=f"'{one.depth:g} m'",
            build__wave_height=f"'{one.height:g} m'", stop__time=f"'{one.time:g} s'",
        ),
        seed=seed,
    )  # fmt: skip


def _even(slope: float, depth: float) -> CaseRun:
    one = WAVES["critical"]
    return case_run(
        case_path("validation/bed_wave.toml"),
        _case(
            one, EVEN_LENGTH, motion__slope=f"{slope * one.slope:g}",
            water__depth=f"'{depth * one.depth:g} m'", build__waves="0", build__wave_height="'0 m'",
            stop__time=f"'{EVEN_TIME:g} s'", record__settle=f"'{EVEN_SETTLE:g} s'",
        ),
        seed=1,
    )  # fmt: skip


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Three even beds and four waves, at the full level alone: some minutes each."""
    if plan.level is not Level.FULL:
        return []
    waves = [_wave(name, seed) for name, one in WAVES.items() for seed in one.seeds]
    return [*(_even(*one) for one in EVEN), *waves]


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Decay at a Froude number of 1, and the direction below and above it."""
    return [_decay(found), _celerity(found)] if plan.level is Level.FULL else []


def _amplitude(got: dict[str, Floats]) -> np.ndarray:
    return got["cosine"] + 1j * got["sine"]


def _decay(found: Found) -> Finding:
    one = WAVES["critical"]
    runs, even = (
        [found[_wave("critical", seed)] for seed in one.seeds],
        [found[_even(*each)] for each in EVEN],
    )
    slope, q, depth, froude, core = (
        float(np.mean([run[key] for run in runs])) for key in ("slope", "q", "depth", "froude", "core")
    )
    points = [(float(e["slope"]), float(e["q"]), float(e["q_s"]), float(e["error"])) for e in even]
    q_s, derivative, error = transport_slope(points, slope, q).tolist()
    k = 2.0 * math.pi / one.length
    diffusion = derivative / core
    sigma = growth(k, diffusion, slope, depth, froude)
    fits = [fitted(run["t"], _amplitude(run)) for run in runs]
    rates = [fit[1].real / sigma.real for fit in fits]
    own = float(np.mean([run["q_s"] for run in runs]))
    ours = [
        Curve(f"seed {seed}", run["t"], 1e3 * np.abs(_amplitude(run)))
        for seed, run in zip(one.seeds, runs, strict=True)
    ]
    theory = [
        Curve(curve.name, run["t"], 1e3 * abs(fit[0]) * np.exp(sigma.real * (run["t"] - run["t"][0])))
        for curve, run, fit in zip(ours, runs, fits, strict=True)
    ]
    noise = float(np.mean([run["noise"] for run in runs]))
    return DECLARED["bed-wave-decay"].finding(
        ours, theory, {"decay": float(np.mean(rates)), "froude": froude, "error": error, "q_s": own / q_s},
        length=one.length, height=1e3 * one.height, rates=', '.join(f'{rate:.3f}' for rate in rates),
        real=-sigma.real, diffusion=1e4 * diffusion, derivative=1e4 * derivative, core=core,
        depth=1e3 * depth, q=1e4 * q, noise=1e3 * noise,
        imag=', '.join(f'{-fit[1].imag / k:.4f}' for fit in fits), imag_2=-sigma.imag / k,
    )  # fmt: skip


def _celerity(found: Found) -> Finding:
    ours, fits, errors, said = list[Curve](), list[Curve](), [], list[str]()
    for name in ("tranquil", "rapid"):
        one = WAVES[name]
        got, k = found[_wave(name, one.seeds[0])], 2.0 * math.pi / one.length
        amplitude = _amplitude(got)
        first, sigma = fitted(got["t"], amplitude)
        speed, froude = -sigma.imag / k, float(got["froude"])
        place = -(np.unwrap(np.angle(amplitude)) - cmath.phase(first)) / k
        label = f"Froude number {froude:.2f}"
        ours.append(Curve(label, got["t"], 1e2 * place))
        fits.append(Curve(label, got["t"], 1e2 * speed * (got["t"] - got["t"][0])))
        errors.append(DECLARED["bed-wave-celerity"].trial(f"celerity-{name}", speed, label))
        errors.append(DECLARED["bed-wave-celerity"].trial(f"froude-{name}", froude))
        said.append(
            f"{label}: {100.0 * speed:.1f} cm/s, decay {-sigma.real:.2f} 1/s, amplitude from "
            f"{1e3 * abs(first):.1f} to {1e3 * abs(amplitude[-1]):.1f} mm, shorter waves "
            f"{1e3 * float(got['noise']):.2f} mm"
        )
    return DECLARED["bed-wave-celerity"].finding(ours, fits, errors, said="; ".join(said))
