"""A shake that Ctrl-C interrupts under make goes on from where it was at the next call, and leaves the snapshots of one in a piece.

Usage: resumed_shake_test.py FEM_STAGE SOURCE_FOLDER
"""

import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

fem_stage, source = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])

with tempfile.TemporaryDirectory() as name:
    root = pathlib.Path(name)
    (root / "cases").mkdir()
    shutil.copy(source / "Makefile.cases", root)
    shutil.copy(source / "cases" / "case_part.py", root / "cases")
    for folder in ("run", "plot", "template"):
        shutil.copytree(source / "cases" / folder, root / "cases" / folder, ignore=shutil.ignore_patterns("__pycache__"))
    (root / "bin").mkdir()
    os.symlink(fem_stage, root / "bin" / "fem_stage")
    environment = {key: value for key, value in os.environ.items() if not key.startswith(("MAKE", "MFLAGS"))}

    def make(out):
        return ["make", "-f", "Makefile.cases", "fem-files", "CASE=template", "SIZE=coarse", "BIN=bin", f"OUT={out}", "THREADS=1", f"PYTHON={sys.executable}"]

    def fem(out):
        return root / out / "template-coarse" / "fem"

    start = time.time()
    whole = subprocess.run(make("whole"), cwd=root, env=environment, capture_output=True, text=True)
    assert whole.returncode == 0, whole.stderr
    snapshots = sorted(path.name for path in fem("whole").glob("snapshot_t*.h5"))
    assert snapshots == ["snapshot_t04.000.h5", "snapshot_t08.000.h5"], snapshots

    # The moment is chosen by what the shake has written: too early it has nothing to go on from, too late it is over.
    checkpoint = fem("parts") / "shake_checkpoint.h5"
    for attempt in range(8):
        shutil.rmtree(root / "parts", ignore_errors=True)
        process = subprocess.Popen(make("parts"), cwd=root, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True)
        while process.poll() is None and not (fem("parts") / "shake.options.txt").exists():
            time.sleep(0.005)
        time.sleep(0.05 * (1 + attempt))
        try:
            os.killpg(process.pid, signal.SIGINT)  # as the terminal does
        except ProcessLookupError:
            pass
        said = process.communicate(timeout=60)[0]
        if checkpoint.exists():
            break
    else:
        sys.exit(f"eight interruptions and no checkpoint:\n{said}")
    assert process.returncode != 0 and not (fem("parts") / ".shaken").exists(), said

    again = subprocess.run(make("parts"), cwd=root, env=environment, capture_output=True, text=True)
    assert again.returncode == 0, again.stderr
    commands = [line for line in again.stdout.splitlines() if line.startswith("bin/fem_stage")]
    assert len(commands) == 1 and commands[0].endswith("--resume"), commands  # mesh and geostatic state are kept
    assert not checkpoint.exists()
    for snapshot in snapshots:
        assert (fem("parts") / snapshot).read_bytes() == (fem("whole") / snapshot).read_bytes(), f"{snapshot} is another"
    third = subprocess.run(make("parts"), cwd=root, env=environment, capture_output=True, text=True)
    assert third.returncode == 0 and "fem_stage" not in third.stdout, third.stdout
print(f"interrupted at attempt {attempt + 1}, gone on, the same snapshots; {time.time() - start:.1f} s")
