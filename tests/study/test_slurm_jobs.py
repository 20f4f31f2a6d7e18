"""What `--on slurm` opens on this machine: a scheduler for the keys of one study. Needs no Slurm."""

import json
import socket
import subprocess
import sys
from urllib.error import HTTPError
from urllib.request import urlopen

import psutil
import pytest

from ryusa.errors import CaseError
from ryusa.study import cluster
from ryusa.study.slurm import SlurmJobs

pytest.importorskip("dask_jobqueue")
distributed = pytest.importorskip("distributed")

TOOLS = {
    "sbatch": 'cp -- "${!#}" "$0.script"; echo "Submitted batch job 7"',
    "scancel": 'echo "$@" > "$0.told"',
    "squeue": "echo 7",
}
AWKWARD = "it's $(touch harm) `touch harm`"


def listening():
    """Addresses on which this process takes connections."""
    every = psutil.Process().net_connections(kind="inet")
    return {(one.laddr.ip, one.laddr.port) for one in every if one.status == psutil.CONN_LISTEN}


@pytest.fixture
def tools(tmp_path, monkeypatch):
    """Commands of Slurm that start nothing."""
    place = tmp_path / "tools"
    place.mkdir()
    for name, does in TOOLS.items():
        (place / name).write_text(f"#!/bin/bash\n{does}\n")
        (place / name).chmod(0o755)
    monkeypatch.setenv("PATH", f"{place}:/usr/bin:/bin")
    return place


@pytest.fixture
def opened(tools, tmp_path):
    """Folder of the runs, with a client of the scheduler and its cluster."""
    folder = tmp_path / AWKWARD / "runs"
    folder.mkdir(parents=True)
    before = listening()
    client, held = SlurmJobs("", 1)._connect(folder, [])
    yield folder, client, held, listening() - before
    cluster.close(client, held, folder / "nothing")


@pytest.mark.skipif(sys.platform != "linux", reason="looks at the sockets of Linux")
def test_the_scheduler_listens_on_the_loopback_alone_and_ends_with_the_study(opened):
    folder, client, held, ports = opened
    assert ports
    assert {ip for ip, _ in ports} == {"127.0.0.1"}
    cluster.close(client, held, folder / "nothing")
    assert not ports & listening()
    assert not list(folder.iterdir())  # the keys are gone


def test_no_page_of_dask_tells_other_users_of_the_machine_of_the_runs(opened):
    _, client, _, ports = opened
    encrypted = int(client.scheduler.address.rpartition(":")[2])
    pages = [port for _, port in ports if port != encrypted]
    assert pages
    for port in pages:
        for name in ("info/main/workers.html", "json/index.html", "metrics", "health"):
            with pytest.raises(HTTPError, match="404"):
                urlopen(f"http://127.0.0.1:{port}/{name}", timeout=5.0)


def test_nobody_without_the_keys_of_the_study_is_let_in(opened):
    folder, client, _, _ = opened
    address = client.scheduler.address
    assert address.startswith("tls://127.0.0.1:")
    (keys,) = folder.iterdir()
    assert keys.stat().st_mode & 0o777 == 0o700
    assert {one.stat().st_mode & 0o777 for one in keys.iterdir()} == {0o600}
    port = address.rpartition(":")[2]
    with pytest.raises(OSError, match=r"Timed out|reset|closed"):
        distributed.Client(f"tcp://127.0.0.1:{port}", timeout=2.0, set_as_default=False)
    other = distributed.security.Security.temporary()  # encrypted too, by another key
    with pytest.raises(OSError, match=r"Timed out|certificate|SSL|closed"):
        distributed.Client(address, security=other, timeout=2.0, set_as_default=False)


def test_the_shell_of_a_job_reads_no_name_as_a_command(opened, tmp_path):
    folder, _, held, _ = opened
    script = held.cluster.job_script()
    lines = [one for one in script.splitlines() if one.startswith("export DASK_")]
    assert len(lines) >= 7
    show = "import json, os; print(json.dumps({k: v for k, v in os.environ.items() if 'TLS' in k}))"
    text = "\n".join([*lines, f"exec {sys.executable} -c {show!r}"])
    done = subprocess.run(["bash", "-c", text], cwd=tmp_path, capture_output=True, text=True, check=True)
    (keys,) = folder.iterdir()
    told = json.loads(done.stdout)
    assert told["DASK_DISTRIBUTED__COMM__TLS__WORKER__KEY"] == str(keys / "key.pem")
    assert not list(tmp_path.rglob("harm"))


def test_an_interface_that_is_not_there_is_refused_with_those_that_are(tools):
    names = ", ".join(name for _, name in socket.if_nameindex())
    with pytest.raises(CaseError, match=f"ib77 must be an interface, one of {names}, or an address"):
        SlurmJobs("ib77", 1)
