#!/usr/bin/env python3
"""One at a time in a folder of results.

    lock.py out/mochikoshi/.lock [--refuse] -- make ...       waits for whoever holds it, or refuses

The lock is the kernel's (flock), so it ends with the processes that hold it, however they end. The file says who that is.
"""

import fcntl
import os
import socket
import sys
import time
from pathlib import Path


def holder(path):
    """Words about who holds the lock."""
    try:
        text = Path(path).read_text().strip()
    except OSError:
        text = ""
    return text or "another process"


def acquire(path, refuse=False):
    """Takes the lock for as long as this process and its children live. Returns the open file, or None when it is
    refused."""
    path = Path(path)
    while True:
        path.parent.mkdir(parents=True, exist_ok=True)
        file = open(path, "a+")
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            patience = "" if refuse else "; waiting for it to end"
            print(f"{path.parent} is in use by {holder(path)}{patience}", file=sys.stderr, flush=True)
            if refuse:
                file.close()
                return None
            fcntl.flock(file, fcntl.LOCK_EX)
        # Who held it may have removed the folder, and somebody else made a new one.
        if path.exists() and os.stat(path).st_ino == os.fstat(file.fileno()).st_ino:
            break
        file.close()
    file.truncate(0)
    file.write(f"process {os.getpid()} on {socket.gethostname()} since {time.strftime('%Y-%m-%d %H:%M:%S', time.gmtime())} UTC\n")
    file.flush()
    os.set_inheritable(file.fileno(), True)
    return file


def main():
    arguments = sys.argv[1:]
    command = arguments[arguments.index("--") + 1 :]
    file = acquire(arguments[0], "--refuse" in arguments[: arguments.index("--")])
    if file is None:
        print("Try again when it has ended, or leave out WAIT=0 to wait for it.", file=sys.stderr)
        return 1
    os.execvp(command[0], command)


if __name__ == "__main__":
    sys.exit(main())
