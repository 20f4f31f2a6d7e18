"""Pictures of the runs of frameworks.py: slices of the three cases in each code, and their curves over time.

    python benchmarks/frameworks_pictures.py [--form short] [--seed 1]

They go to build/benchmarks/frameworks/pictures.
"""

import argparse
from itertools import product

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from frameworks import WORK, frames_of
from frameworks_cases import Bulk, forms, measured, settled
from matplotlib.collections import EllipseCollection

CODES = ("ryusa", "LIGGGHTS", "ryusa (Thornton)", "YADE")
WHEN = {"silo": 0.5, "drum": 1.0, "impact": 0.6}  # share of the time at which a slice is drawn
CURVES = {"silo": "left", "drum": "index 2", "impact": "way [m]"}


def slices(form: str, bulk: Bulk, seed: int) -> None:
    """Grains within one large diameter of the plane y = 0."""
    with np.load(settled(bulk, seed, WORK / "packings")) as file:
        d, of = file["d"], file["of"]
    there = [code for code in CODES if frames_of(form, bulk.name, code, seed).exists()]
    figure, axes = plt.subplots(1, len(there), figsize=(3.6 * len(there), 4.2), sharey=True, squeeze=False)
    near = max(one for _, one, _ in bulk.kinds)
    for axis, code in zip(axes[0], there, strict=True):
        with np.load(frames_of(form, bulk.name, code, seed)) as file:
            k = min(round(WHEN[bulk.name] * (len(file["t"]) - 1)), len(file["t"]) - 1)
            t, x, first = float(file["t"][k]), file["x"][k], file["x"][0]
        slab = (np.abs(x[:, 1]) < 0.5 * near) | (d == bulk.ball)
        shown = np.flatnonzero(slab)
        colour = of if bulk.name == "drum" else np.floor(first[:, 2] / (5.0 * near)) % 2
        if bulk.ball:
            colour[-1] = 2
        axis.add_collection(EllipseCollection(
            d[shown], d[shown], np.zeros(len(shown)), units="xy", offsets=x[shown][:, [0, 2]],
            offset_transform=axis.transData, array=colour[shown], cmap="viridis", clim=(0, 2), lw=0.2,
            edgecolors="k",
        ))  # fmt: skip
        corners = bulk.mesh()
        low = -0.02 if bulk.name == "silo" else corners[..., 2].min()
        high = corners[..., 2].max() if bulk.spin else float(np.nanmax(first[:, 2])) + near
        axis.set(title=f"{code}, t = {t:.3g} s", aspect="equal", xlabel="x [m]", ylim=(low, high))
        axis.set_xlim(corners[..., 0].min(), corners[..., 0].max())
    axes[0][0].set_ylabel("z [m]")
    figure.savefig(WORK / "pictures" / f"{form}-{bulk.name}.png", dpi=110, bbox_inches="tight")
    plt.close(figure)


def curves(form: str) -> None:
    """What is compared over time, all seeds."""
    figure, axes = plt.subplots(1, 3, figsize=(13.0, 3.8))
    for axis, (name, key) in zip(axes, CURVES.items(), strict=True):
        bulk = forms()[form][name]
        for (k, code), seed in product(enumerate(CODES), range(1, 10)):
            if (path := frames_of(form, name, code, seed)).exists():
                with np.load(path) as file:
                    row = measured(bulk, settled(bulk, seed, WORK / "packings"), file["t"], file["x"])
                axis.plot(row["t [s]"], row[key], f"C{k}", lw=0.8, label=code if seed == 1 else None)
        axis.set(title=name, xlabel="t [s]", ylabel=key)
        axis.legend()
    figure.savefig(WORK / "pictures" / f"{form}-curves.png", dpi=110, bbox_inches="tight")
    plt.close(figure)


def main() -> None:
    """Draw what there is."""
    asked = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    asked.add_argument("--form", default="short", choices=list(forms()))
    asked.add_argument("--seed", type=int, default=1)
    how = asked.parse_args()
    (WORK / "pictures").mkdir(parents=True, exist_ok=True)
    for bulk in forms()[how.form].values():
        if any(frames_of(how.form, bulk.name, code, how.seed).exists() for code in CODES):
            slices(how.form, bulk, how.seed)
    curves(how.form)


if __name__ == "__main__":
    main()
