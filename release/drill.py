"""Use what was built as its users will, under the conditions that break programs.

    python release/drill.py DIST

The wheel is installed into one environment outside the checkout. Under each condition a user then does what
USES lists, a run is killed and continued to the same bits, and a case of an earlier version is rewritten.
What must not happen: a command that fails, a traceback, a file that is not there afterwards.
"""

import os
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

UV = Path(sys.executable).with_name("uv")
SHORT = "--set stop.saltations=3 --set record.settle='0.2 s'"
SWEEP = "ryusa sweep saltation.toml --over motion.slope=0.0055,0.0065 --seeds 1 --measure saltation"
USES = {  # command: what it leaves behind
    "ryusa --version": "",
    "ryusa doctor": "",
    "ryusa new saltation": "saltation.toml",
    "ryusa check saltation.toml": "",
    f"ryusa run saltation.toml {SHORT}": "runs/saltation/grains.vtkhdf",
    "ryusa inspect runs/saltation": "",
    "ryusa measure runs/saltation saltation --csv hops.csv": "hops.csv",
    "ryusa draw runs/saltation tracks": "runs/saltation/pictures/tracks.png",
    "ryusa view runs/saltation": "runs/saltation/view.html",
    "ryusa film runs/saltation --speed 1 --size 480x270 -o grains.webp": "grains.webp",
    "ryusa report runs/saltation --quiet": "runs/saltation/report.html",
    "ryusa export runs/saltation --to csv -o grains.csv": "grains.csv",
    f"{SWEEP} {SHORT} --no-pages -j 1 -q": "runs/sweep-saltation/sweep.csv",
}  # fmt: skip
KILLED = (
    "ryusa run movable_bed.toml --set record.settle='0 s' --set stop.time='{time}' -o {folder}"
    " --checkpoint 1s --quiet"
)
SAME_BITS = """
import sys
import numpy as np
import ryusa

one, other = (ryusa.Results.open(path) for path in sys.argv[1:])
assert len(one.frames.t) == len(other.frames.t) > 1
for name in ("x", "v"):
    a, b = (np.asarray(getattr(run.frames, name)) for run in (one, other))
    assert a.tobytes() == b.tobytes(), name
"""
FULL_HOME = 'mount -t tmpfs -o size=16k full "$HOME" && cat /dev/zero > "$HOME/full" 2>/dev/null; exec "$@"'
NOBODY = 65534
ORDINARY = ("setpriv", f"--reuid={NOBODY}", f"--regid={NOBODY}", "--clear-groups")
OLD_ENOUGH = "import sys; sys.exit(sys.version_info < (3, 11))"
AT_A_TIME = 2  # conditions


@dataclass(frozen=True)
class Condition:
    """Under what a user works.

    Attributes
    ----------
    about : in words.
    around : what a command is begun with.
    environment : variables that differ.
    place : folder to work in, below one of its own.
    cold : whether nothing that was compiled under another condition is at hand.
    owner : number of the user who works, if it is not this one.
    """

    about: str
    around: tuple[str, ...] = ()
    environment: dict[str, str] = field(default_factory=dict[str, str])
    place: str = "work"
    cold: bool = False
    owner: int | None = None


def python_for_all() -> str:
    """A Python that another user can start too: not one in the home of root."""
    for own in (sys.executable, shutil.which("python3", path="/usr/bin:/bin")):
        if own is not None and os.getuid() == 0:
            words = [*ORDINARY, os.path.realpath(own), "-c", OLD_ENOUGH]
            if subprocess.run(words, check=False, capture_output=True).returncode == 0:
                return own
    return sys.executable


def conditions() -> list[Condition]:
    """All that this machine can make; of the others it is said that they were left out."""
    root = os.getuid() == 0
    new = ("unshare",) if root else ("unshare", "--map-root-user")
    every = [
        Condition("as it comes", cold=True),
        Condition("an installation that its user cannot write", ORDINARY if root else (), cold=True,
                  owner=NOBODY if root else None),
        Condition("a home on a full disk", (*new, "--mount", "sh", "-c", FULL_HOME, "sh"), cold=True),
        Condition("no network", (*new, "--net")),
        Condition("LANG=C", environment={"LANG": "C", "LC_ALL": "C"}),
        Condition("an ASCII terminal", environment={
            "LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}),
        Condition("LANG=ja_JP.UTF-8", environment={"LANG": "ja_JP.UTF-8", "LC_ALL": "ja_JP.UTF-8"}),
        Condition("a path with spaces and Japanese", place="河床 の 計算/a b"),
    ]  # fmt: skip
    made: list[Condition] = []
    for one in every:
        with tempfile.TemporaryDirectory() as home:
            tried = subprocess.run(
                [*one.around, "true"], check=False, env={**os.environ, "HOME": home}, capture_output=True
            )
        if tried.returncode:
            print(f"{one.about}: this machine does not allow it, left out")
        else:
            made.append(one)
    return made


class User:
    """One who works with an installation under a condition."""

    def __init__(self, folder: Path, bin: Path, under: Condition, compiled: Path) -> None:
        """Make a home and a place to work in."""
        self.under, self.place, self.home = under, folder / under.place, folder / "home"
        self.place.mkdir(parents=True)
        self.home.mkdir()
        self.bin = bin
        kept = {key: value for key, value in os.environ.items() if key in {"TERM", "TMPDIR"}}
        self.environment = {
            **kept, "PATH": f"{bin}:/usr/bin:/bin", "HOME": str(self.home), "RYUSA_RUN_TIMES": "off",
            **({} if under.cold else {"RYUSA_CACHE": str(compiled)}), **under.environment,
        }  # fmt: skip
        if under.owner is not None:
            for path in (folder, *folder.rglob("*")):
                os.chown(path, under.owner, under.owner)

    def begin(self, *words: str | Path) -> subprocess.Popen[str]:
        """Begin a command."""
        return subprocess.Popen(
            [*self.under.around, *map(str, words)], cwd=self.place, env=self.environment, text=True,
            encoding="utf-8", errors="replace", stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            start_new_session=True,
        )  # fmt: skip

    def do(self, *words: str | Path, leaves: str = "") -> str:
        """Carry out a command that must succeed and leave a file behind; what it prints."""
        process = self.begin(*words)
        said, _ = process.communicate()
        lacking = leaves and not (self.place / leaves).exists()
        if process.returncode or "Traceback" in said or lacking:
            why = f"it ended with {process.returncode}" if process.returncode else f"{leaves} is not there"
            raise RuntimeError(f"{self.under.about}: {shlex.join(map(str, words))}: {why}\n{said}")
        return said

    def killed_and_continued(self) -> None:
        """Kill a run once it has a checkpoint, continue it, and compare it with one that nobody killed."""
        self.do("ryusa", "new", "movable_bed")
        for stop in ("0.25 s", "1 s"):  # the longer one where the first is over too soon
            words = [
                shlex.split(KILLED.format(time=stop, folder=f"runs/{name}")) for name in ("killed", "whole")
            ]
            shutil.rmtree(self.place / "runs" / "killed", ignore_errors=True)
            process = self.begin(*words[0])
            while process.poll() is None and not [*(self.place / "runs" / "killed").glob("checkpoint*")]:
                time.sleep(0.05)
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
                process.communicate()
                break
        else:
            said, _ = process.communicate()
            raise RuntimeError(f"{self.under.about}: the run was over before it could be killed\n{said}")
        self.do("ryusa", "resume", "runs/killed", "--quiet")
        self.do(*words[1])
        self.do(self.bin / "python", "-c", SAME_BITS, "runs/killed", "runs/whole")

    def upgrades(self) -> None:
        """Rewrite a case without a schema, as there were before 1.0, and check it."""
        text = (self.place / "saltation.toml").read_text(encoding="utf-8")
        old = "".join(line for line in text.splitlines(keepends=True) if not line.startswith("schema"))
        (self.place / "old.toml").write_text(old, encoding="utf-8")
        if self.under.owner is not None:
            os.chown(self.place / "old.toml", self.under.owner, self.under.owner)
        self.do("ryusa", "upgrade", "old.toml")
        if "schema = 1" not in (self.place / "old.toml").read_text(encoding="utf-8"):
            raise RuntimeError(f"{self.under.about}: the rewritten case does not say its schema")
        self.do("ryusa", "check", "old.toml")


def install(folder: Path, dist: Path) -> Path:
    """Install the wheel of DIST into an environment that all can read; its folder of programs."""
    env = folder / "env"
    wheel = next(dist.glob("ryusa-*.whl"))
    python, own = env / "bin" / "python", ("--reinstall-package", "ryusa")
    for words in (
        (UV, "venv", "--quiet", "--python", python_for_all(), env),
        (UV, "pip", "install", "--quiet", "--python", python, *own, wheel),
    ):
        subprocess.run([str(one) for one in words], check=True)
    return env / "bin"


def worked(folder: Path, bin: Path, number: int, under: Condition) -> str:
    """Work under a condition; what there is to say.

    Raises
    ------
    RuntimeError : what failed.
    """
    begun, place = time.monotonic(), folder / f"{number}"
    place.mkdir()
    user = User(place, bin, under, folder / "compiled")
    version = user.do("ryusa", "--version").strip()
    for words, leaves in USES.items():
        user.do(*shlex.split(words), leaves=leaves)
    user.killed_and_continued()
    user.upgrades()
    uses = ", ".join(dict.fromkeys(words.split()[1] for words in [*USES][1:]))
    said = f"{uses}; killed and continued to the same bits; upgrade ({time.monotonic() - begun:.0f} s)"
    return f"{under.about}: {version}\n  {said}"


def drill(dist: Path, named: Sequence[str]) -> None:
    """Go through every condition, or those whose words are named."""
    with tempfile.TemporaryDirectory() as name, ProcessPoolExecutor(AT_A_TIME) as pool:
        folder = Path(name)
        folder.chmod(0o755)
        bin = install(folder, dist)
        every = [
            pool.submit(worked, folder, bin, number, under)
            for number, under in enumerate(conditions())
            if not named or any(word in under.about for word in named)
        ]
        for one in every:
            print(one.result())


if __name__ == "__main__":
    sys.stdout.reconfigure(line_buffering=True)
    drill(Path(sys.argv[1]).resolve(), sys.argv[2:])
