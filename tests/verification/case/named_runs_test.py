"""Named runs (RUN=, SET=) compute what differs and nothing else, leave the base run alone, and lose nothing when a setting is
refused or a run is interrupted; two makes in one folder take turns. The programs are scripts that write the files that the
real ones write.

Usage: named_runs_test.py SOURCE_FOLDER
"""

import fcntl
import hashlib
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

source = pathlib.Path(sys.argv[1])
# mpm_stage refuses an unknown key, is interrupted where a file says so, and notes how it was called.
PROGRAM = """#!/bin/sh
name=$(basename "$0")
command=$1
shift
settings= resume=
while [ $# -gt 0 ]; do
  case $1 in -o) out=$2 ;; --set) settings="$settings $2" ;; --resume) resume=" --resume" ;; esac
  shift
done
echo "$name $command$resume$settings" >>"{log}"
case "$settings" in *facto=*) echo "unknown key 'facto'. Did you mean 'factor'?" >&2; exit 1 ;; esac
case "$name $command" in
  "fem_stage mesh") mkdir -p "$out"; echo "mesh$settings" >"$out/mesh.msh" ;;
  "fem_stage geostatic") echo "geostatic$settings" >"$out/geostatic.h5" ;;
  "fem_stage shake") for t in 04 08; do echo "$settings" >"$out/snapshot_t$t.000.h5"; done; echo "{{}}" >"$out/summary.json" ;;
  "transfer_tool run") echo "$settings" >"$out" ;;
  "mpm_stage run")
    mkdir -p "$out/frames"
    if [ -e "{interrupt}" ] && [ -z "$resume" ]; then echo "$settings" >"$out/checkpoint.h5"; exit 2; fi
    rm -f "$out/checkpoint.h5"
    echo "$settings" >"$out/frames/runout_00000.vtkhdf"; echo "{{}}" >"$out/summary.json" ;;
esac
"""

with tempfile.TemporaryDirectory() as name:
    root = pathlib.Path(name)
    (root / "cases").mkdir()
    shutil.copy(source / "Makefile.cases", root)
    shutil.copy(source / "cases" / "case_part.py", root / "cases")
    shutil.copytree(source / "cases" / "run", root / "cases" / "run")
    shutil.copytree(source / "cases" / "template", root / "cases" / "dam")
    plot = root / "cases" / "plot"
    plot.mkdir()
    (plot / "print_summary.py").write_text("")
    log, interrupt = root / "log", root / "interrupt"
    for program in ("fem_stage", "transfer_tool", "mpm_stage"):
        path = root / "bin" / program
        path.parent.mkdir(exist_ok=True)
        path.write_text(PROGRAM.format(log=log, interrupt=interrupt))
        path.chmod(0o755)
    environment = {key: value for key, value in os.environ.items() if not key.startswith(("MAKE", "MFLAGS"))}
    base, runs = root / "out" / "dam", root / "out" / "dam" / "runs"

    def make(*words):
        log.write_text("")
        command = ["make", "-f", "Makefile.cases", "CASE=dam", "BIN=bin", f"PYTHON={sys.executable}", *words]
        result = subprocess.run(command, cwd=root, env=environment, capture_output=True, text=True)
        return result, [line for line in log.read_text().split("\n") if line]

    def run(run_name, setting, status=0):
        """What a named run computed, as program and settings."""
        result, ran = make("named", "UNTIL=mpm", f"RUN={run_name}", *([f"SET={setting}"] if setting else []))
        assert (result.returncode == 0) == (status == 0), (run_name, setting, result.stdout, result.stderr)
        return result, ran

    def state():
        """Everything of the base run, with dates."""
        return {path: (path.stat().st_mtime_ns, hashlib.sha256(path.read_bytes()).hexdigest())
                for path in base.rglob("*") if path.is_file() and runs not in path.parents}

    def frames(run_name):
        return (runs / run_name / "mpm" / "frames" / "runout_00000.vtkhdf").read_text().strip()

    # A new run without a base computes everything; the base run then does too, by its dates.
    half = "/residual_strength/factor=0.5"
    _, ran = run("first", f"mpm:{half}")
    assert [line.split(" ", 2)[:2] for line in ran] == [["fem_stage", "mesh"], ["fem_stage", "geostatic"], ["fem_stage", "shake"],
                                                        ["transfer_tool", "run"], ["mpm_stage", "run"]], ran
    assert not (base / "mpm").exists()
    result, ran = make("mpm-files")
    assert result.returncode == 0 and len(ran) == 5, (ran, result.stderr)
    before = state()

    # Only what differs, wherever the rest lies.
    assert run("weak", f"mpm:{half}")[1] == []  # the same as the first, frames and all
    assert run("weaker", "mpm:/residual_strength/factor=0.4")[1] == ["mpm_stage run /residual_strength/factor=0.4"]
    assert run("weaker", "mpm:/residual_strength/factor=0.4")[1] == []
    cap = "/rules/0/residual_strength/drained_cap=true"
    _, ran = run("capped", f"transfer:{cap} mpm:{half}")
    assert ran == [f"transfer_tool run {cap}", f"mpm_stage run {half}"], ran
    loud = "/shake/peak_acceleration=3"
    _, ran = run("loud", f"fem:{loud}")
    assert ran == [f"fem_stage shake {loud}", "transfer_tool run", "mpm_stage run"], ran
    _, ran = run("loud_weak", f"fem:{loud} mpm:{half}")  # the shaking is that of another named run
    assert ran == [f"mpm_stage run {half}"], ran
    _, ran = run("title", 'mpm:/sleep={"speed": 0.01, "calm": 0.5} mpm:/title=two words')
    assert ran == ['mpm_stage run /sleep={"speed": 0.01, "calm": 0.5} /title=two words'], ran
    # What the file says already, and comments, are no difference.
    assert run("same", "mpm:/residual_strength/factor=1.0")[1] == []
    text = root / "cases" / "dam" / "mpm.json"
    text.write_text("// why\n" + text.read_text())
    assert run("same", "mpm:/residual_strength/factor=1")[1] == []
    assert state() == before, "a named run has changed the base run"

    # Refused settings change nothing.
    kept = frames("weaker")
    result, ran = run("weaker", "mpm:/residual_strength/facto=0.3", status=1)
    assert "Did you mean 'factor'" in result.stderr and "as it was" in result.stderr, result.stderr
    assert frames("weaker") == kept and run("weaker", None)[1] == []
    result, _ = run("new", "mpm:/residual_strength/facto=0.3", status=1)
    assert make("list-runs")[0].stdout.count("weaker") == 1
    for setting, words in (("mmp:/a=1", "Did you mean 'mpm:'"), (half, "does not say whose"), ("mpm:a=1", "/pointer=value"),
                           ("import:/time=1", "has no import.json")):
        result, ran = run("bad", setting, status=1)
        assert words in result.stderr and ran == [], (setting, result.stderr)
    for bad in ("a/b", "..", ".", "-x", "base", ".hidden", "a;b"):
        result, ran = run(bad, f"mpm:{half}", status=1)
        assert "RUN" in result.stderr and ran == [], (bad, result.stderr)
    assert "is new" in run("nobody", None, status=1)[0].stderr
    assert "add RUN=" in make("mpm-files", f"SET=mpm:{half}")[0].stderr

    # An interrupted run goes on; with other settings it begins anew; the base run does the same.
    interrupt.write_text("")
    setting = "/residual_strength/factor=0.3"
    assert run("cut", f"mpm:{setting}", status=2)[1] == [f"mpm_stage run {setting}"]
    assert run("cut", None)[1] == [f"mpm_stage run --resume {setting}"] and frames("cut") == setting
    assert run("cut", f"mpm:{setting}")[1] == []
    run("cut2", f"mpm:{setting[:-1]}2", status=2)
    interrupt.unlink()
    assert run("cut2", f"mpm:{half} mpm:/title=t")[1] == [f"mpm_stage run {half} /title=t"]
    interrupt.write_text("")
    assert make("mpm-files")[0].returncode != 0  # its mpm.json has a new date
    assert make("mpm-files")[1] == ["mpm_stage run --resume"]
    interrupt.unlink()

    # One at a time, and removal of one run.
    with open(runs / ".weak.lock", "a+") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        lock.truncate(0)
        lock.write("process 7 on somewhere since yesterday\n")
        lock.flush()
        result, ran = make("named", "UNTIL=mpm", "RUN=weak", f"SET=mpm:{half}", "WAIT=0")
        assert result.returncode != 0 and "in use by process 7 on somewhere since yesterday" in result.stderr, result.stderr
        assert make("clean", "RUN=weak")[0].returncode != 0 and (runs / "weak").exists()
    assert make("clean", "RUN=weak")[0].returncode == 0 and not (runs / "weak").exists() and (runs / "weaker").exists()
    assert "There is no run 'weak'" in make("clean", "RUN=weak")[0].stderr
    assert frames("first") == half

    # Two waiters for one folder take turns.
    slow = [sys.executable, str(root / "cases/run/lock.py"), str(root / "turn" / ".lock"), "--", "sh", "-c",
            f"echo in >>{root}/turns; sleep 0.3; echo out >>{root}/turns"]
    processes = [subprocess.Popen(slow, stderr=subprocess.PIPE, text=True) for _ in range(3)]
    told = "".join(process.communicate()[1] for process in processes)
    assert (root / "turns").read_text().split() == ["in", "out"] * 3 and "since" in told, told
print("named runs compute what differs, and lose nothing")
