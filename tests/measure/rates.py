"""How often averages are right on series whose answer is known: rates of false alarm and of miss, errors.

    python tests/measure/rates.py            # the table of docs/measuring.md, 4000 series a rate: 5 minutes

The bands are those of design/0010, written down before the first measurement.
"""

import math
import sys
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from ryusa.measure.statistics import average
from ryusa.measure.steadiness import truncation

Floats = NDArray[np.float64]
Rng = np.random.Generator
ANY = (0.0, 100.0)  # asked for nothing


@dataclass(frozen=True)
class Noise:
    """A stationary series of mean 0 and variance 1, plus white noise, and the standard error of its mean."""

    name: str
    n: int
    tau: float = 0.0  # correlation time [samples]; 0: white
    white: float = 0.0  # variance of white noise on top

    @property
    def spectrum(self) -> float:
        """Spectrum at frequency zero."""
        phi = math.exp(-1.0 / self.tau) if self.tau else 0.0
        return (1.0 + phi) / (1.0 - phi) + self.white

    @property
    def error(self) -> float:
        """True standard error of the mean, for a record of many correlation times."""
        return math.sqrt(self.spectrum / self.n)

    def draw(self, rng: Rng) -> Floats:
        """One series."""
        noise = rng.normal(size=self.n)
        if self.tau:
            phi = math.exp(-1.0 / self.tau)
            noise[0] /= math.sqrt(1.0 - phi * phi)
            noise = lfilter([1.0], [1.0, -phi], noise) * math.sqrt(1.0 - phi * phi)
        return noise + math.sqrt(self.white) * rng.normal(size=self.n)


@dataclass(frozen=True)
class Rate:
    """A share that is asked for: of series, in percent."""

    group: str
    row: str  # of the table, which gives the worst of its rates
    what: str
    band: tuple[float, float]  # lowest and highest [%]
    one: Callable[[Rng], bool]

    def measure(self, n: int, seed: int) -> float:
        """Share over n series [%]."""
        rng = np.random.default_rng(seed)
        return 100.0 * sum(self.one(rng) for _ in range(n)) / n


def red(tau: float, independent: float, white: float = 0.0) -> Noise:
    """AR(1) series worth so many independent samples; with white noise, without counting that."""
    phi = math.exp(-1.0 / tau)
    name = f"AR(1), tau = {tau:g}, {independent:g} independent samples"
    if white:
        name = f"white noise of variance {white:g} over {name}"
    return Noise(name, round(independent * (1.0 + phi) / (1.0 - phi)), tau, white)


def long(tau: float, times: float) -> Noise:
    """AR(1) series of so many correlation times."""
    return Noise(f"AR(1), tau = {tau:g}, {times:g} tau", round(times * tau), tau)


SIGNALS: dict[str, tuple[str, float, Callable[[Floats, float], Floats]]] = {
    "linear drift": ("R", 7.0, lambda s, _: s),
    **{
        f"transient of {one:g} window": ("bias", 5.0, lambda s, _, one=one: np.exp(-s / one))
        for one in (0.02, 0.05, 0.1)
    },
    **{
        f"transient of {one:g} window": ("R", 10.0, lambda s, _, one=one: np.exp(-s / one))
        for one in (0.2, 0.5, 1.0, 2.0)
    },
    **{
        f"step at {one:g}": ("R", 12.0, lambda s, _, one=one: np.where(s > one, 1.0, 0.0))
        for one in (0.1, 0.25, 0.35, 0.5, 0.75, 0.9)
    },
    **{
        f"oscillation of {one:g} window": (
            "R", 10.0, lambda s, phase, one=one: np.sin(2.0 * math.pi * (s / one + phase)),
        )
        for one in (1.0, 2.0)
    },
}  # fmt: skip


ENDS = ("step at 0.1", "step at 0.9")


def added(noise: Noise, name: str, strength: float, rng: Rng) -> Floats:
    """A series with a signal of this strength: r.m.s. about its mean (R), or mean (bias), in true errors."""
    kind, _, shape = SIGNALS[name]
    signal = shape((np.arange(noise.n) + 0.5) / noise.n, rng.uniform())
    size = signal.mean() if kind == "bias" and strength < 100.0 else signal.std()
    return noise.draw(rng) + signal * strength * noise.error / size


def changes(series: Floats) -> bool:
    """Whether the test of steadiness rejects."""
    return average("", "", [series]).changes


def alarms() -> list[Rate]:
    """False alarms on stationary series."""
    band = (0.0, 7.0)
    stationary = [("white noise, 50 to 2000 samples", Noise(f"{n} samples", n)) for n in (50, 200, 2000)]
    for count in (20, 50, 200):
        row = f"{count} independent samples, tau = 1 to 100"
        stationary += [(row, red(tau, count)) for tau in (1, 3, 10, 30, 100)]
        stationary.append(("a slow AR(1) under white noise of ten times its variance", red(10, count, 10.0)))
    rates = [
        Rate("false alarm", row, one.name, band, lambda rng, one=one: changes(one.draw(rng)))
        for row, one in stationary
    ]
    quiet, few = red(10, 50), red(10, 10)

    def swinging(rng: Rng) -> bool:
        phase = (np.arange(quiet.n) + 0.5) / quiet.n * 10.0 + rng.uniform()
        return changes(quiet.draw(rng) + math.sqrt(2.0) * np.sin(2.0 * math.pi * phase))

    row = "oscillation of a tenth of the window"
    below = "10 independent samples (marked as too short)"
    return [
        *rates,
        Rate("false alarm", row, row, band, swinging),
        Rate("false alarm", below, below, ANY, lambda rng: changes(few.draw(rng))),
    ]


def family(name: str, kind: str) -> str:
    """Signals that share a row of the table."""
    if name.startswith("transient"):
        return f"transient of {'0.02 to 0.1 window' if kind == 'bias' else '0.2 to 2 windows'}"
    if name.startswith("step"):
        return "step at 0.1 or 0.9 of the window" if name in ENDS else "step at 0.25 to 0.75 of the window"
    return "oscillation of 1 or 2 windows" if name.startswith("oscillation") else name


def misses() -> list[Rate]:
    """Misses of what changes, over noise worth 20 and 200 independent samples."""
    found: list[Rate] = []
    for noise in (red(10, 20), red(10, 200)):
        for name, (kind, usual, _) in SIGNALS.items():
            for strength, band in ((usual, (0.0, 5.0)), (100.0, (0.0, 1.0)), (0.5 * usual, ANY)):
                row = f"{family(name, kind)}, {kind} = {strength:g}"
                if strength == 100.0:
                    row = "each of these, R = 100"
                found.append(
                    Rate(
                        "miss", row, f"{name}, {strength:g}, over {noise.name}", band,
                        lambda rng, x=noise, name=name, s=strength: not changes(added(x, name, s, rng)),
                    )
                )  # fmt: skip
    return found


def errors() -> list[Rate]:
    """Printed errors over the true one, and whether they hold the true mean."""

    def covered(noise: Noise, rng: Rng) -> bool:
        found = average("", "", [noise.draw(rng)])
        return abs(found.value) < 2.0 * found.error

    def near(noise: Noise, rng: Rng) -> bool:
        return abs(average("", "", [noise.draw(rng)]).error / noise.error - 1.0) < 0.2

    lengths = [long(tau, times) for tau in (1, 10, 100) for times in (50, 200, 1000)]
    lengths.append(Noise("white noise of variance 10 over AR(1), tau = 10, 50 tau", 500, 10.0, 10.0))
    found = [
        Rate(
            "true mean within two printed errors", f"{row} correlation times", one.name, (91.0, 100.0),
            lambda rng, one=one: covered(one, rng),
        )
        for row, one in [(round(one.n / one.tau), one) for one in lengths]
    ]  # fmt: skip
    found += [
        Rate(
            "printed error within 20 % of the true one", "1000 correlation times", one.name, (80.0, 100.0),
            lambda rng, one=one: near(one, rng),
        )
        for one in lengths
        if one.n == 1000 * one.tau
    ]  # fmt: skip
    return found + [
        Rate(
            "marked as too short", "10 correlation times", one.name, (90.0, 100.0),
            lambda rng, one=one: average("", "", [one.draw(rng)]).short,
        )
        for one in (long(1, 10), long(10, 10), long(100, 10))
    ]  # fmt: skip


def begins() -> list[Rate]:
    """What is left out at the begin."""
    noise = red(10, 50)
    s = (np.arange(noise.n) + 0.5) / noise.n

    def dropped(rng: Rng) -> bool:
        return not truncation(noise.draw(rng)) <= 0.25

    def clean(rng: Rng, length: float) -> bool:
        signal = 10.0 * np.exp(-s / length)
        share = truncation(noise.draw(rng) + signal)
        if math.isnan(share):
            return False
        rest = signal[math.ceil(share * noise.n) :]
        return float(rest.mean()) < noise.error * math.sqrt(noise.n / len(rest))

    row = "transient of 0.02 to 0.1 window, ten standard deviations high"
    return [
        Rate(
            "more than a quarter left out at the begin", "50 independent samples", noise.name, (0.0, 10.0),
            dropped,
        ),
        *(
            Rate(
                "bias left below one standard error", row, f"{one:g} window", (90.0, 100.0),
                lambda rng, one=one: clean(rng, one),
            )
            for one in (0.02, 0.05, 0.1)
        ),
    ]  # fmt: skip


def mean_error(noise: Noise, n: int, seed: int) -> float:
    """Mean printed error of n series over the true one [-]; asked for: 0.8 to 1.2 from 50 tau on."""
    rng = np.random.default_rng(seed)
    return float(np.mean([average("", "", [noise.draw(rng)]).error for _ in range(n)])) / noise.error


def every() -> list[Rate]:
    """All rates."""
    return [*alarms(), *misses(), *errors(), *begins()]


def table(n: int, seed: int) -> str:
    """Everything measured on n series a rate, as Markdown; the worst rate of each row."""
    worst: dict[tuple[str, str], tuple[float, tuple[float, float]]] = {}
    for one in every():
        share, key = one.measure(n, seed), (one.group, one.row)
        pick = min if one.band[0] > 0.0 else max
        worst[key] = pick(share, worst[key][0]) if key in worst else share, one.band
    lines = ["| | series | measured | asked for |", "|---|---|---|---|"]
    for (group, row), (share, band) in worst.items():
        low, high = band
        asked = "" if band == ANY else f"at most {high:g} %" if low == 0.0 else f"at least {low:g} %"
        lines.append(f"| {group} | {row} | {share:.1f} % | {asked} |")
    for times in (5, 10, 20, 50, 200, 1000):
        found = [mean_error(long(tau, times), n // 4, seed) for tau in (1, 10, 100)]
        asked = "0.8 to 1.2" if times >= 50 else ""
        row = f"| mean printed error over the true one | {times} correlation times, tau = 1 to 100"
        lines.append(f"{row} | {min(found):.2f} to {max(found):.2f} | {asked} |")
    return "\n".join(lines)


if __name__ == "__main__":
    print(table(int(sys.argv[1]) if len(sys.argv) > 1 else 4000, 2026))
