"""Damaged input: a file cut short at any length ends with exit status 1, a message, and no output under any name; one
with bytes overwritten is either refused like that or gives a sound result, and never a crash.

Usage: damaged_files.py TRANSFER_TOOL FOLDER
"""

import pathlib
import random
import subprocess
import sys
import tempfile

tool, folder = sys.argv[1], pathlib.Path(sys.argv[2])


def called(*arguments):
    return subprocess.run([tool, *map(str, arguments)], capture_output=True, text=True, errors="replace", timeout=60)


def refused(result, outputs, what):
    assert result.returncode == 1, f"{what}: exit status {result.returncode}\n{result.stderr}"
    assert result.stderr.strip(), f"{what}: no message"
    assert not result.stdout.strip(), f"{what}: wrote to standard output: {result.stdout[:200]}"
    left = [path.name for path in outputs.iterdir()]
    assert not left, f"{what}: left {left}"


def lengths(size):
    """Short ones one by one, then a spread, then the last bytes."""
    return sorted({*range(0, 64, 7), *range(64, size, max(1, size // 60)), *range(size - 9, size)})


def check_truncated(source, where, outputs):
    whole = source.read_bytes()
    damaged = where / "damaged.h5"
    refusals = 0
    for length in lengths(len(whole)):
        damaged.write_bytes(whole[:length])
        run = called("run", "-q", folder / "transfer.json", "--snapshot", damaged, "-o", outputs / "particles.h5")
        refused(run, outputs, f"run with {source.name} cut to {length} of {len(whole)} bytes")
        refused(called("info", damaged), outputs, f"info of {source.name} cut to {length} bytes")
        refusals += 2
    return refusals


def check_overwritten(source, where, outputs, rounds):
    whole = source.read_bytes()
    random.seed(14)
    damaged = where / "damaged.h5"
    statuses = {}
    for _ in range(rounds):
        data = bytearray(whole)
        for _ in range(random.choice((1, 8, 64))):
            data[random.randrange(len(data))] = random.randrange(256)
        damaged.write_bytes(data)
        run = called("run", "-q", folder / "transfer.json", "--snapshot", damaged, "-o", outputs / "particles.h5")
        assert run.returncode in (0, 1), f"exit status {run.returncode}: {run.stderr}"
        statuses[run.returncode] = statuses.get(run.returncode, 0) + 1
        if run.returncode == 1:
            refused(run, outputs, "run with overwritten bytes")
        else:
            for written in outputs.iterdir():
                written.unlink()
        info = called("info", damaged)
        assert info.returncode in (0, 1), f"info: exit status {info.returncode}: {info.stderr}"
    return statuses


with tempfile.TemporaryDirectory() as name:
    where = pathlib.Path(name)
    outputs = where / "out"
    outputs.mkdir()
    snapshot, particles = where / "snapshot.h5", where / "particles.h5"
    assert called("import", "-q", folder / "import.json", "-o", snapshot).returncode == 0
    assert called("run", "-q", folder / "transfer.json", "--snapshot", snapshot, "-o", particles).returncode == 0
    count = check_truncated(snapshot, where, outputs) + check_truncated(particles, where, outputs)
    refused(called("run", folder / "transfer.json", "--snapshot", where / "no.h5", "-o", outputs / "p.h5"), outputs,
            "missing snapshot")
    refused(called("run", where / "no.json", "--snapshot", snapshot, "-o", outputs / "p.h5"), outputs, "missing case")
    refused(called("run", folder / "transfer.json", "--snapshot", particles, "-o", outputs / "p.h5"), outputs,
            "particles where a snapshot is needed")
    statuses = check_overwritten(snapshot, where, outputs, 150)
    assert set(statuses) == {0, 1}, f"the overwritten bytes never mattered, or always: {statuses}"
print(f"{count} truncated files refused; overwritten bytes: {statuses}")
