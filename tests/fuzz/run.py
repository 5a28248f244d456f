"""Runs the fuzz targets, each for the same time, from the committed corpus on. What a target ends on is kept, and so is
what reaches new code, both in OUT. Exit status 1 when one has found something.

Usage: run.py BIN CORPUS CASES OUT [--seconds 180] [--only mesh_file,geometry] [--jobs 2]
A finding is mended, and its input (made small by `fuzz_X -minimize_crash=1 ...`) goes into the corpus, where every
test run replays it.
"""

import argparse
import concurrent.futures
import os
import pathlib
import re
import subprocess
import sys

JSON = {"fem_case": "fem", "mpm_scene": "mpm", "transfer_case": "transfer", "import_tables": "import"}
# A scene may ask for as many particles as the machine holds, which takes its time: that is no finding.
SLOW = {"mpm_scene": ["-fork=1", "-ignore_timeouts=1", "-ignore_ooms=1"]}


def words(target, cases, folder):
    """Keys and names of the cases of that kind, as a dictionary of libFuzzer."""
    if target not in JSON:
        return []
    texts = [path.read_text() for path in cases.rglob("*.json")]
    found = sorted({word for text in texts for word in re.findall(r'"[A-Za-z_0-9]{2,30}"', text)})
    path = folder / "words.dict"
    path.write_text("".join(f'"{word[1:-1]}"\n' for word in found))
    return [f"-dict={path}"]


def fuzz(target, arguments):
    folder = arguments.out / target
    (folder / "new").mkdir(parents=True, exist_ok=True)
    before = set(folder.glob("*-*"))
    command = [str(arguments.bin / f"fuzz_{target}"), f"-max_total_time={arguments.seconds}", "-timeout=20", "-rss_limit_mb=3000",
               "-max_len=70000", "-print_final_stats=1", f"-artifact_prefix={folder}/", *SLOW.get(target, []),
               *words(target, arguments.cases, folder), str(folder / "new"), str(arguments.corpus / target)]
    environment = os.environ | {"ASAN_OPTIONS": "detect_leaks=0:allocator_may_return_null=1", "OMP_NUM_THREADS": "1"}
    with open(folder / "log.txt", "w") as log:
        status = subprocess.run(command, stdout=log, stderr=subprocess.STDOUT, env=environment).returncode
    said = (folder / "log.txt").read_text(errors="replace")
    runs = re.findall(r"stat::number_of_executed_units:\s*(\d+)", said) or re.findall(r"#(\d+):? ", said)
    found = sorted(path for path in set(folder.glob("*-*")) - before if path.name.startswith(("crash-", "leak-", "timeout-", "oom-")))
    if target in SLOW:
        found = [path for path in found if path.name.startswith("crash-")]
    return target, int(runs[-1]) if runs else 0, len(list((folder / "new").iterdir())), found, status


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("bin", "corpus", "cases", "out"):
        parser.add_argument(name, type=pathlib.Path)
    parser.add_argument("--seconds", type=int, default=180, help="for each target")
    parser.add_argument("--only", default="", help="these targets, separated by commas")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    arguments = parser.parse_args()
    targets = sorted(path.name for path in arguments.corpus.iterdir())
    if arguments.only:
        targets = [target for target in targets if target in arguments.only.split(",")]
    failed = not targets
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        for target, runs, new, found, status in pool.map(lambda target: fuzz(target, arguments), targets):
            bad = found or (status != 0 and target not in SLOW)
            failed = failed or bool(bad)
            print(f"{target:15s} {runs:9d} runs, {new:5d} inputs that reach new code" +
                  (f"; FOUND {', '.join(map(str, found)) or 'something'}, see {arguments.out / target / 'log.txt'}" if bad else ""), flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
