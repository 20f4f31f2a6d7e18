"""Times ryusa beside LAMMPS, LIGGGHTS and YADE on the same grains, and writes a table with its machine.

    python benchmarks/run.py                          # everything: see README.md for how long
    python benchmarks/run.py --quick                  # small sizes, three pairs: minutes
    python benchmarks/run.py --parts speed --only W1-20k W2-20k --threads 2 --peers LAMMPS
    python benchmarks/run.py --parts memory scaling

What is done is kept in the work folder after every round, and not done again; another ryusa, or --fresh,
begins anew. A machine on which others work is refused; with --anyway the table says so.
"""

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import checks
import costs
import machine
import report
import speed
import workloads
from peer_lammps import found_lammps, found_liggghts
from peer_ryusa import Ryusa, digest
from peer_yade import found_yade
from workloads import Grains, Workload, workload

HERE = Path(__file__).resolve().parent
BUILD = HERE.parent / "build"
PARTS = ("law", "flows", "speed", "memory", "start", "scaling", "kernels")
QUICK = 0.25  # of the steps
MEMORY = ("1k", "20k", "200k", "1M")
SCALING = ("100", "1k", "2k", "10k", "20k", "100k", "200k", "1M")


class Bench:
    """What was asked for, what there is, and what is done."""

    def __init__(self, options: argparse.Namespace) -> None:
        self.options = options
        self.scale = QUICK if options.quick else 1.0
        self.pairs = options.pairs or (3 if options.quick else 7)
        self.work: Path = options.work
        self.work.mkdir(parents=True, exist_ok=True)
        self.file = self.work / f"{options.name}.json"
        found = {"LAMMPS": found_lammps(options.builds), "LIGGGHTS": found_liggghts(), "YADE": found_yade()}
        self.peers: dict[str, list[Any]] = {name: found[name] for name in options.peers if found[name]}
        self.state = self._begin()
        self.watch = machine.Watch(self.state.get("spin", float("inf")))

    def _begin(self) -> dict[str, Any]:
        fresh = self.options.fresh or not self.file.exists()
        before: dict[str, Any] = {} if fresh else json.loads(self.file.read_text())
        if before.get("anyway") and not self.options.anyway:
            print(f"{self.file}: not taken on a quiet machine, begun anew")
            before = {}
        if before and before.get("source") != digest():
            print(f"{self.file}: taken with another ryusa; builds and skins of the peers stay, no more")
            kept = {key: {"tuned": row["tuned"]} for key, row in before.get("speed", {}).items()}
            before = {"speed": kept, "anyway": before["anyway"], "spin": before.get("spin", float("inf"))}
        versions = {"ryusa": Ryusa().version(), **_packages()}
        for name, builds in self.peers.items():
            versions |= {f"{name}, {one.label}": one.version() for one in builds}
        about = machine.describe()
        command = " ".join(["python", "benchmarks/run.py", *map(_without_folders, sys.argv[1:])])
        return before | {
            "sittings": [*before.get("sittings", []), {"date": about.pop("date"), "command": command}],
            "anyway": before.get("anyway", False) or self.options.anyway,
            "machine": about,
            "source": digest(),
            "versions": before.get("versions", {}) | versions,
        }

    def keep(self) -> None:
        """Keep all figures, and the page made of them."""
        self.state["spin"] = self.watch.fastest
        self._write(self.work)

    def _write(self, folder: Path) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / self.file.name).write_text(json.dumps(self.state, indent=1) + "\n")
        (folder / self.file.name).with_suffix(".md").write_text(report.markdown(self.state))

    def grains(self, load: Workload) -> tuple[Path, int]:
        """First grains of a workload, settled when they are not there yet, and how many are free."""
        words = [load.name, load.size, *(["--poly"] if load.spread and not load.plane else [])]
        command = [sys.executable, str(HERE / "prepare.py"), *words, "--work", str(self.work / "grains")]
        done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)
        path = Path(done.stdout.splitlines()[-1])
        return path, len(Grains.load(str(path)).x)

    def speed(self) -> None:
        """Every workload, one thread count after the other."""
        rows = self.state.setdefault("speed", {})
        for load in self._loads():
            path, n = self.grains(load)
            peers = {} if load.column else self.peers
            for threads in self.options.threads:
                key = f"{load.key} on {threads}"
                print(f"{key}: {n} grains", flush=True)
                speed.side_by_side(
                    load, path, n, threads, peers, pairs=self.pairs, scale=self.scale,
                    anyway=self.options.anyway, work=self.work, row=rows.setdefault(key, {}), keep=self.keep,
                    watch=self.watch,
                )  # fmt: skip

    def _loads(self) -> list[Workload]:
        keys = self.options.only or (workloads.QUICK if self.options.quick else workloads.FULL)
        return [workloads.named(key) for key in keys]

    def law(self) -> list[dict[str, Any]]:
        """Collisions of two grains."""
        return checks.law(self.peers, self.work)

    def flows(self) -> list[dict[str, Any]]:
        """Averages of the three workloads."""
        files = {name: self.grains(workload(name, "2k"))[0] for name in ("W1", "W2", "W3")}
        return checks.flows(files, self.peers, round(self.scale * checks.FLOW_STEPS), self.work)

    def memory(self) -> list[dict[str, Any]]:
        """Memory for a grain."""
        sizes = MEMORY[:2] if self.options.quick else MEMORY
        made = {size: self.grains(workload("W2", size)) for size in sizes}
        files, counts = {k: one[0] for k, one in made.items()}, {k: one[1] for k, one in made.items()}
        return costs.memory(files, counts, self.peers, 100, self.work)

    def start(self) -> list[dict[str, Any]]:
        """Start-up."""
        return costs.start(self.grains(workload("W1", "2k"))[0], self.peers, self.work)

    def scaling(self) -> dict[str, Any]:
        """Cost against the number of grains."""
        sizes = SCALING[:4] if self.options.quick else SCALING
        made = {size: self.grains(workload("W1", size)) for size in sizes}
        files, counts = {k: one[0] for k, one in made.items()}, {k: one[1] for k, one in made.items()}
        return costs.scaling(files, counts, self.options.threads, self.scale, self.work)

    def kernels(self) -> list[dict[str, Any]]:
        """Parts of a step."""
        done = subprocess.run(
            [sys.executable, str(HERE / "kernels.py")], stdout=subprocess.PIPE, text=True, check=True
        )
        return [json.loads(line) for line in done.stdout.splitlines()]

    def run(self) -> None:
        """Do the parts that were asked for."""
        for part in self.options.parts:
            if part == "speed":
                self.speed()
            elif part not in self.state:
                print(part, flush=True)
                self.state[part] = getattr(self, part)()
            self.keep()
        self._write(self.options.out)


def _without_folders(word: str) -> str:
    return Path(word).name if Path(word).is_absolute() else word


def _packages() -> dict[str, str]:
    from importlib.metadata import version

    return {name: version(name) for name in ("numba", "llvmlite", "numpy")}


def _key(word: str) -> str:
    try:
        return workloads.named(word).key
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _count(word: str) -> int:
    if not word.isdecimal() or int(word) < 1:
        raise argparse.ArgumentTypeError(f"{word!r} is no number of at least 1")
    return int(word)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    cores = len(os.sched_getaffinity(0))
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=list(PARTS))
    parser.add_argument(
        "--only",
        nargs="+",
        type=_key,
        metavar="WORKLOAD",
        help="such as W1-20k, W2-20k-poly, W1-20k-water, W3-200k",
    )
    parser.add_argument("--threads", nargs="+", type=_count, default=[n for n in (1, 2) if n <= cores])
    parser.add_argument(
        "--peers", nargs="*", choices=["LAMMPS", "LIGGGHTS", "YADE"], default=["LAMMPS", "LIGGGHTS", "YADE"]
    )
    parser.add_argument("--pairs", type=_count, help="rounds; 7, quick 3")
    parser.add_argument("--quick", action="store_true", help="2k grains, a quarter of the steps")
    parser.add_argument("--anyway", action="store_true", help="also on a machine that is not quiet")
    parser.add_argument("--fresh", action="store_true", help="forget what was done before")
    parser.add_argument("--name", default="", help="of the table; quick or full when not given")
    parser.add_argument(
        "--work", type=Path, default=BUILD / "benchmarks", help="grains and figures on the way"
    )
    parser.add_argument("--builds", type=Path, default=BUILD / "peers", help="builds of LAMMPS, see peers.sh")
    parser.add_argument(
        "--out",
        type=Path,
        help="where the table goes when all is done; benchmarks/results for everything, else the work folder",
    )
    options = parser.parse_args()
    options.name = options.name or f"{'quick' if options.quick else 'full'}"
    options.work = options.work.resolve()
    partly = options.quick or options.anyway or options.only or options.parts != list(PARTS)
    options.out = options.out or (options.work if partly else HERE / "results")
    bench = Bench(options)
    why = machine.noise(bench.watch)
    if why and not options.anyway:
        sys.exit(f"this machine is not quiet: {why}. Wait, or give --anyway")
    bench.run()
    print(report.markdown(bench.state))
    print(f"kept in {options.out / bench.file.stem}.md")


if __name__ == "__main__":
    main()
