"""The script of docs/many-runs.md that starts scheduler, workers and command in one job. Needs no Slurm."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))
from sweeping import STUDY

PAGE = (Path(__file__).parents[3] / "docs" / "many-runs.md").read_text(encoding="utf-8")
(SCRIPT,) = re.findall(r"```bash\n(.*?)```", PAGE, flags=re.DOTALL)
AWKWARD = "it's $(touch harm) `touch harm`"
STAND_INS = {
    "srun": 'for k in $(seq "$SLURM_NTASKS"); do "$@" & done; wait',
    "hostname": "echo 127.0.0.1",
}
# in the place of `ryusa` in a job: what is there while it goes on, and then the command itself
LOOKS = """
import json, os, sys
from pathlib import Path
from urllib.error import HTTPError
from urllib.request import urlopen

import psutil
from distributed import Client
from distributed.security import Security

*words, on, where = sys.argv[1:]
address = where.removeprefix("dask:")
seen = {"on": on, "address": address}
(keys,) = Path.cwd().glob(".keys-*")
seen["modes"] = [oct(one.stat().st_mode & 0o777) for one in (keys, *sorted(keys.iterdir()))]

def refusal(*given, **more):
    try:
        Client(*given, timeout=2.0, set_as_default=False, **more).close()
    except OSError as error:
        return str(error)
    return "none"

seen["in plain"] = refusal(address.replace("tls:", "tcp:"), security=Security(require_encryption=False))
os.system("openssl req -x509 -newkey rsa:2048 -nodes -subj /CN=x -keyout other -out other.cert 2> /dev/null")
other = Security(tls_ca_file="other.cert", tls_client_cert="other.cert", tls_client_key="other")
seen["with another key"] = refusal(address, security=other)
shell = psutil.Process().parent()
taking = {
    one.laddr.port
    for child in shell.children(recursive=True)
    for one in child.net_connections(kind="inet")
    if one.status == psutil.CONN_LISTEN
}
seen["pages"] = []
for port in taking:
    for name in ("info/main/workers.html", "json/index.html", "metrics", "health"):
        try:
            urlopen(f"http://127.0.0.1:{port}/{name}", timeout=2.0)
        except HTTPError as error:
            seen["pages"].append(error.code)
        except OSError:  # an encrypted port
            break
        else:
            seen["pages"].append(200)
Path("seen.json").write_text(json.dumps(seen))
from ryusa.cli import main
sys.argv = ["ryusa", *words, on, where]
main()
"""


def test_the_script_is_one_that_bash_reads() -> None:
    subprocess.run(["bash", "-n"], input=SCRIPT, text=True, check=True)


@pytest.mark.full
@pytest.mark.skipif(sys.platform != "linux", reason="looks at the sockets of Linux")
def test_a_job_gives_the_table_of_processes_and_lets_nobody_in_without_its_keys(tmp_path) -> None:
    pytest.importorskip("distributed")
    place, tools = tmp_path / AWKWARD, tmp_path / "tools"
    (place / "mine").mkdir(parents=True)
    tools.mkdir()
    for name, does in STAND_INS.items():
        (tools / name).write_text(f"#!/bin/bash\n{does}\n")
        (tools / name).chmod(0o755)
    (place / "mine" / "study.py").write_text(STUDY)
    (place / "looks.py").write_text(LOOKS)
    (place / "dask.sh").write_text(SCRIPT)
    here = f"{tools}:{Path(sys.executable).parent}:{os.environ['PATH']}"
    job = {**os.environ, "PATH": here, "SLURM_NTASKS": "2", "SLURM_JOB_ID": str(os.getpid())}
    words = ("study", "mine", "--seeds", "2", "-q", "-j", "2", "-o")
    done = subprocess.run(
        ["bash", "dask.sh", "python", "looks.py", *words, "by workers"],
        cwd=place, env=job, capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    seen = json.loads((place / "seen.json").read_text())
    assert seen["on"] == "--on"
    assert seen["address"].startswith("tls://127.0.0.1:")
    assert seen["modes"] == ["0o700", "0o600", "0o600"]
    assert re.search(r"Timed out|reset|closed", seen["in plain"])
    assert re.search(r"Timed out|certificate|SSL|closed", seen["with another key"])
    assert seen["pages"] and set(seen["pages"]) == {404}
    assert not list(place.glob(".keys-*"))  # they end with the job
    assert not list(tmp_path.rglob("harm"))
    command = [sys.executable, "-c", "from ryusa.cli import main; main()", *words, "here"]
    subprocess.run(command, cwd=place, check=True)
    tables = [(place / out / "mine" / "mine.csv").read_bytes() for out in ("by workers", "here")]
    assert tables[0] == tables[1]
    assert tables[0].count(b"\n") == 3
