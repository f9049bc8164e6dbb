"""Runs one program and says what it cost: CPU seconds of all its threads, wall seconds, time to its first whole PNG."""

import os
import subprocess
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

PNG_END = b"\x00\x00\x00\x00IEND\xaeB`\x82"
POLL_SECONDS = 0.005
TAIL_LINES = 15


class Failure(Exception):
    """Something the person at the keyboard can mend; the text says how."""


@dataclass
class Run:
    cpu_s: float
    wall_s: float
    first_png_s: float | None
    output: str


def is_whole_png(path):
    """A PNG counts once its closing chunk is on disk."""
    try:
        with open(path, "rb") as file:
            file.seek(-len(PNG_END), os.SEEK_END)
            return file.read() == PNG_END
    except OSError:
        return False


def run(command, env, first_png, timeout):
    """Waits by polling, so that the first PNG is seen within POLL_SECONDS; the polling is not in the program's CPU time."""
    Path(first_png).unlink(missing_ok=True)
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
        start = time.perf_counter()
        process = subprocess.Popen([str(word) for word in command], stdout=out, stderr=err, env=env)
        first_png_s, status, usage = watch(process, first_png, start, timeout)
        wall_s = time.perf_counter() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0), err.seek(0)
        if process.returncode != 0:
            raise Failure(describe(command, process.returncode, err.read() + out.read()))
        return Run(usage.ru_utime + usage.ru_stime, wall_s, first_png_s, out.read())


def watch(process, first_png, start, timeout):
    first_png_s = None
    while True:
        pid, status, usage = os.wait4(process.pid, os.WNOHANG)
        now = time.perf_counter() - start
        if first_png_s is None and is_whole_png(first_png):
            first_png_s = now
        if pid:
            return first_png_s, status, usage
        if now > timeout:
            process.kill()
            os.wait4(process.pid, 0)
            process.returncode = -9
            raise Failure(f"{process.args[0]} was still running after {timeout} s; --timeout allows more")
        time.sleep(POLL_SECONDS)


def describe(command, code, text):
    how = f"was killed by signal {-code}" if code < 0 else f"ended with exit code {code}"
    tail = "\n".join("    " + line for line in text.strip().splitlines()[-TAIL_LINES:])
    return f"{' '.join(str(word) for word in command)}\n  {how}:\n{tail or '    (it printed nothing)'}"
