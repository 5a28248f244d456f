"""Programs killed at random moments: what is under a final name is whole, the folder is free at once, the next run gives
the undisturbed one's results, and a shake or
runout that goes on from its checkpoint the same bits.

Usage: killed.py FEM_STAGE TRANSFER_TOOL MPM_STAGE CASES [ROUNDS]
"""
import pathlib
import random
import shutil
import signal
import sys
import tempfile
import time

import chain

rounds = int(sys.argv[5]) if len(sys.argv) > 5 else 4
random.seed(14)
kills = resumed = 0
with tempfile.TemporaryDirectory() as name:
    sound, tried = pathlib.Path(name) / "sound", pathlib.Path(name) / "tried"
    lasted, wanted = chain.undisturbed(sound)

    for _ in range(rounds):
        shutil.rmtree(tried, ignore_errors=True)
        for stage in chain.STAGES:
            how = random.choice((signal.SIGKILL, signal.SIGTERM, signal.SIGINT))
            process = chain.start(stage, tried)
            time.sleep(random.uniform(0.02, 1.1) * lasted[stage])
            process.send_signal(how)
            said = process.communicate(timeout=120)[1]
            kills += 1
            chain.results(tried)  # raises where something is not whole
            if (tried / {"mpm": "mpm/checkpoint.h5", "shake": "fem/shake_checkpoint.h5"}.get(stage, "none")).exists():
                again = chain.run(stage, tried, "--resume")
                resumed += 1
            else:
                again = chain.run(stage, tried)
            assert again.returncode == 0, \
                f"{stage} after {how.name} ({said}): exit status {again.returncode}\n{again.stderr}"
        found = chain.results(tried)
        assert found.keys() == wanted.keys(), f"other files: {sorted(found.keys() ^ wanted.keys())}"
        for file in wanted:
            assert found[file] == wanted[file], f"{file} is another after the kills"
print(f"{kills} kills in {rounds} chains, {resumed} shakes and runouts resumed: nothing cut under a final name, same results")
