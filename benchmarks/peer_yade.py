"""YADE: the same grains and law, in a script that its own Python runs."""

import json
import re
import shutil
import subprocess
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import workloads
from peer import Job, threads_of_one
from workloads import DROP


@dataclass(frozen=True)
class Yade:
    """YADE with ViscElMat and ViscElPhys_Basic; its cell is periodic in all three directions."""

    program: Path
    label: str = "Debian"
    name: str = field(default="YADE", init=False)
    slip: str = field(default=DROP, init=False)
    skins: dict[str, tuple[float, ...]] = field(
        default_factory=lambda: {"W1": (0.1, 0.2, 0.4), "W2": (0.025, 0.05, 0.1), "W3": (0.1, 0.2, 0.4)},
        init=False,
    )
    share: float = field(default=0.1, init=False)

    def version(self) -> str:
        said = subprocess.run([self.program, "--version"], capture_output=True, text=True, check=False)
        found = re.search(r"version: (\S+)", said.stdout + said.stderr)
        return found[1] if found else "?"

    def command(self, job: Job, folder: Path) -> tuple[list[str], dict[str, str]]:
        law = {
            "k_n": workloads.K_N, "k_s": workloads.K_S, "eta_n": workloads.ETA_N, "eta_s": workloads.ETA_S,
            "mu": workloads.MU, "d": workloads.D, "density": workloads.DENSITY, "gravity": job.load.gravity,
        }  # fmt: skip
        whole = job.plain() | {"law": law, "slope": job.load.slope, "plane": job.load.plane}
        (folder / "job.json").write_text(json.dumps(whole))
        script = Path(__file__).resolve().parent / "in_yade.py"
        words = [str(self.program), "-n", "-x", f"-j{job.threads}", str(script), "job.json"]
        environment = {k: v for k, v in threads_of_one(job.threads).items() if not k.startswith("PYTHON")}
        return words, environment

    def read(self, job: Job, folder: Path, said: str) -> tuple[float, dict[str, Any]]:
        found = json.loads(said.partition("FOUND ")[2].splitlines()[0])
        return float(found["loop"]), {"pairs": found["pairs"]}


def found_yade() -> list[Yade]:
    """YADE on the path."""
    program = shutil.which("yade")
    return [Yade(Path(program))] if program else []
