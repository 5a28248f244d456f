"""Results and where they go: what is no regular file is not replaced, a folder that cannot take results is wrong input
and said before the computation, a full disk ends with exit status 2, a message and nothing under a final name, and
closed standard streams do not put messages into results.

Usage: output_places.py TRANSFER_TOOL MPM_STAGE FOLDER (with import.json, transfer.json and mpm.json)
"""

import os
import pathlib
import resource
import shutil
import signal
import stat
import subprocess
import sys
import tempfile

tool, stage, folder = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])


def called(*arguments, before=None, **more):
    return subprocess.run([str(a) for a in arguments], capture_output=True, text=True, errors="replace", timeout=120,
                          preexec_fn=before, **more)


def refused(result, what, status=1):
    assert result.returncode == status, f"{what}: exit status {result.returncode}\n{result.stderr}"
    assert result.stderr.strip() and "unexpected" not in result.stderr and "filesystem error" not in result.stderr, \
        f"{what}: {result.stderr}"


def small_files():
    """What a full disk is like: no file grows beyond 8 kB."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (8192, 8192))


with tempfile.TemporaryDirectory() as name:
    where = pathlib.Path(name)
    snapshot, particles = where / "s.h5", where / "p.h5"
    imported = ["import", "-q", folder / "import.json", "-o"]
    handed = ["run", "-q", folder / "transfer.json", "--snapshot", snapshot, "-o"]
    runout = ["run", "-q", folder / "mpm.json", "--particles", particles, "-o"]
    assert called(tool, *imported, snapshot).returncode == 0
    assert called(tool, *handed, particles).returncode == 0

    # An input is no place for a result, under whatever name.
    inputs = where / "inputs"
    shutil.copytree(folder, inputs)
    alias = where / "alias.h5"
    alias.symlink_to(snapshot)
    tables = [table for table in inputs.glob("*.csv") if table.name in (inputs / "import.json").read_text()]
    assert tables
    for command, places in ((["import", "-q", inputs / "import.json", "-o"], [inputs / "import.json", *tables]),
                            (["run", "-q", inputs / "transfer.json", "--snapshot", snapshot, "-o"], [snapshot, alias, inputs / "transfer.json"])):
        for place in places:
            kept = place.read_bytes()
            refused(called(tool, *command, place), f"transfer_tool {command[0]} -o {place}")
            assert place.read_bytes() == kept, place

    pipe, plain = where / "pipe", where / "plain"
    os.mkfifo(pipe)
    plain.write_text("kept")
    for command in (imported, handed):
        for place in (pipe, where, plain / "below.h5", ""):
            refused(called(tool, *command, place), f"transfer_tool {command[0]} -o {place}")
    for place in (pipe, plain, plain / "below", ""):
        refused(called(stage, *runout, place), f"mpm_stage -o {place}")
    assert stat.S_ISFIFO(pipe.stat().st_mode) and plain.read_text() == "kept"

    for program, command, place in ((tool, imported, where / "a.h5"), (tool, handed, where / "b.h5"),
                                    (stage, runout, where / "mpm")):
        result = called(program, *command, place, before=small_files)
        refused(result, f"no space: {command[0]}", 2)
        assert "File too large" in result.stderr, result.stderr
        left = [p for p in (list(place.rglob("*")) if place.is_dir() else [place]) if p.is_file() and p.suffix == ".h5"]
        assert not left, f"left {left}"

    for closed in ([0], [1], [2], [0, 1, 2]):
        out = where / f"closed{''.join(map(str, closed))}"

        def close():
            for descriptor in closed:
                os.close(descriptor)

        result = subprocess.run([stage, *map(str, runout[0:1] + runout[2:]), str(out)], timeout=120, preexec_fn=close,
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        assert result.returncode == 0, f"closed {closed}: exit status {result.returncode}"
        for table in ("front.csv", "ledger.csv"):
            rows = (out / table).read_text().splitlines()
            assert all(len(row.split(",")) == len(rows[0].split(",")) for row in rows), f"closed {closed}: {table}"
    parts = list(where.rglob("*.part"))
    assert not parts, f"left {parts}"
print("devices kept, folders checked first, no space said, streams apart")
