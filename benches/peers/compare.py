#!/usr/bin/env python3
"""Tyndall and VTK draw the same volume, in turns; a report says what each frame cost and how the images differ.

    python3 benches/peers/compare.py                      # emission-absorption and Phong
    python3 benches/peers/compare.py --columns scatter    # scattered light, which takes VTK long
    python3 benches/peers/compare.py --columns vtk        # VTK only
    python3 benches/peers/compare.py --columns startup    # process start to first PNG

Only Python 3.11 is needed to start it: VTK, numpy and Pillow go into a venv of their own under --out.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

sys.dont_write_bytecode = True  # no __pycache__ in the working tree

import setting
import tyndall_frames
from processes import Failure, run

HERE = Path(__file__).resolve().parent
REPOSITORY = HERE.parents[1]
PINNED = ["vtk==9.7.2", "numpy==2.4.6", "pillow"]
UNPINNED = ["vtk", "numpy", "pillow"]
WINDOW_HINT = (
    "VTK draws off screen through EGL or OSMesa. If its messages are about windows or contexts, install libegl1 and "
    "libgl1-mesa-dri, or libosmesa6; --vtk-window picks one"
)
IMPORTABLE = "import vtkmodules, numpy, PIL"


@dataclass(frozen=True)
class Column:
    key: str
    title: str
    lighting: str
    mapper: str | None  # VTK's, or None for Tyndall
    light_turns: bool = False

    def scene(self):
        """Which of Tyndall's scenes it draws."""
        return f"{self.lighting}-turned" if self.light_turns else self.lighting


# In the order they take turns.
COLUMNS = [
    Column("vtk-cpu-ea", "VTK EA, CPU mapper", "ea", "cpu"),
    Column("tyndall-ea", "Tyndall EA", "ea", None),
    Column("vtk-gpu-ea", "VTK EA, GPU mapper", "ea", "gpu"),
    Column("vtk-cpu-phong", "VTK Phong, CPU mapper", "phong", "cpu"),
    Column("tyndall-phong", "Tyndall Phong", "phong", None),
    Column("vtk-gpu-phong", "VTK Phong, GPU mapper", "phong", "gpu"),
]
# VTK computes all anew in each frame, whatever changed; Tyndall keeps the light of a volume until the light turns.
SCATTERING_COLUMNS = [
    Column("vtk-gpu-scatter", "VTK volumetric scattering, GPU mapper", "scatter", "gpu"),
    Column("tyndall-scatter", "Tyndall light volume, view turns", "scatter", None),
    Column("tyndall-scatter-turned", "Tyndall light volume, view and light turn", "scatter", None, light_turns=True),
]
ALL_COLUMNS = COLUMNS + SCATTERING_COLUMNS


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--columns",
        default="local",
        help="local (emission-absorption and Phong), scatter, all, vtk, tyndall, startup, or keys with commas between: "
        + ", ".join(c.key for c in ALL_COLUMNS),
    )
    parser.add_argument("--volume", choices=setting.VOLUMES, default="engine")
    parser.add_argument("--rounds", type=at_least_one, default=3, help="how often each column has its turn (3)")
    parser.add_argument("--frames", type=at_least_one, default=5, help="timed frames per turn, after 2 to warm up (5)")
    parser.add_argument("--tyndall", type=Path, help="the binary (target/release/tyndall, built if absent)")
    parser.add_argument("--out", type=Path, default=REPOSITORY / "target/peers", help="venv, volumes and report")
    parser.add_argument("--gpu", choices=("auto", "software", "hardware"), default="auto", help="which GPU drivers to use")
    parser.add_argument("--vtk-window", choices=("auto", "egl", "osmesa"), default="auto", help="VTK's off-screen window")
    parser.add_argument("--timeout", type=int, default=600, help="seconds one process may take (600)")
    args = parser.parse_args()
    args.out = args.out.resolve()
    return args


def at_least_one(text):
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError("must be at least 1")
    return number


def chosen_columns(text):
    groups = {
        "all": ALL_COLUMNS,
        "local": COLUMNS,
        "scatter": SCATTERING_COLUMNS,
        "startup": COLUMNS,
        "vtk": [c for c in COLUMNS if c.mapper],
        "tyndall": [c for c in COLUMNS if not c.mapper],
    }
    if text in groups:
        return groups[text]
    keys = text.split(",")
    unknown = [key for key in keys if key not in {c.key for c in ALL_COLUMNS}]
    if unknown:
        raise Failure(f"no column {unknown[0]!r}; there are {', '.join([*groups, *(c.key for c in ALL_COLUMNS)])}")
    return [c for c in ALL_COLUMNS if c.key in keys]


# --- the venv ---------------------------------------------------------------------------------------------------------


def enter_venv(folder):
    """Makes the venv if need be and goes on inside it."""
    if Path(sys.prefix).resolve() == folder.resolve():
        return
    python = folder / "bin/python"
    if not python.exists():
        make_venv(folder)
    if not succeeds([python, "-c", IMPORTABLE]):
        install(python)
    os.execv(python, [str(python), *sys.argv])


def succeeds(command):
    return subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode == 0


def make_venv(folder):
    say(f"making a venv in {folder}")
    result = subprocess.run([sys.executable, "-m", "venv", folder], capture_output=True, text=True)
    if result.returncode != 0:
        shutil.rmtree(folder, ignore_errors=True)
        raise Failure(f"python3 -m venv failed; on Debian install python3-venv\n{result.stdout}{result.stderr}".rstrip())


def install(python):
    pip = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    if not succeeds([python, "-m", "pip", "--version"]):
        raise Failure(f"the venv of {python} has no pip; delete the folder, install python3-venv and pip, run again")
    say(f"installing {' '.join(PINNED)}")
    if subprocess.run([*pip, *PINNED]).returncode == 0:
        return
    say("those versions cannot be had here; taking what can: the figures may not compare with published ones")
    if subprocess.run([*pip, *UNPINNED]).returncode != 0:
        raise Failure("pip could not install vtk, numpy and pillow: see its message above (no network? no wheel?)")


# --- what is drawn ----------------------------------------------------------------------------------------------------


def make_volumes(folder):
    """Both volumes; a remark for each whose bytes are not the published ones."""
    import volumes

    folder.mkdir(parents=True, exist_ok=True)
    remarks = []
    for name, volume in setting.VOLUMES.items():
        path, digest = volumes.make(name, folder)
        if digest != volume.sha256:
            remarks.append(
                f"{path.name} has SHA-256 {digest}, published is {volume.sha256}: numpy rounds differently here. "
                "The columns still compare with each other."
            )
    return remarks


def find_tyndall(path):
    if path:
        if not path.is_file():
            raise Failure(f"--tyndall {path}: no such file")
        return path.resolve()
    binary = REPOSITORY / "target/release/tyndall"
    if not binary.exists():
        say("building Tyndall (release)")
        if not shutil.which("cargo"):
            raise Failure(f"neither {binary} nor cargo is there; give the binary with --tyndall")
        if subprocess.run(["cargo", "build", "--release", "-p", "tyndall-cli"], cwd=REPOSITORY).returncode != 0:
            raise Failure("cargo build --release -p tyndall-cli failed: see above")
    return binary


def tyndall_version(binary):
    """What it says of itself, and the commit of the tree it was probably built from."""
    version = subprocess.run([binary, "--version"], capture_output=True, text=True).stdout.strip()
    git = ["git", "-C", REPOSITORY, "describe", "--always", "--dirty"]
    commit = subprocess.run(git, capture_output=True, text=True).stdout.strip() if shutil.which("git") else ""
    return f"{version or binary}, working tree at {commit or 'an unknown commit'}"


def is_software(choice):
    """Without a device file for a GPU there is none to use."""
    if choice != "auto":
        return choice == "software"
    return not [*Path("/dev").glob("dri/renderD*"), *Path("/dev").glob("nvidia[0-9]*"), *Path("/dev").glob("dxg")]


# --- taking turns -----------------------------------------------------------------------------------------------------


class Bench:
    def __init__(self, args, columns, runtime_dir):
        self.args = args
        self.software = is_software(args.gpu)
        self.data, self.images = args.out / "data", args.out / "images"
        self.images.mkdir(parents=True, exist_ok=True)
        self.runtime_dir = os.environ.get("XDG_RUNTIME_DIR") or runtime_dir
        self.tyndall = find_tyndall(args.tyndall) if any(not c.mapper for c in columns) else None
        self.scenes = {x: tyndall_frames.write_scene(self.data, args.volume, x) for x in tyndall_frames.TITLES}

    def facts(self):
        return {
            "Tyndall": tyndall_version(self.tyndall) if self.tyndall else "not run",
            "graphics drivers": "software" if self.software else "the machine's own",
        }

    def prefix(self, column):
        return self.images / f"{self.args.volume}_{column.key}"

    def vtk_environment(self):
        """No display, so that VTK takes its off-screen window."""
        env = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
        env |= {"XDG_RUNTIME_DIR": self.runtime_dir, "PYTHONDONTWRITEBYTECODE": "1"}
        window = {"egl": "vtkEGLRenderWindow", "osmesa": "vtkOSOpenGLRenderWindow"}.get(self.args.vtk_window)
        if window:
            env["VTK_DEFAULT_OPENGL_WINDOW"] = window
        if self.software:
            env["LIBGL_ALWAYS_SOFTWARE"] = "1"
        return env

    def vtk(self, column, warm_up, frames):
        words = [sys.executable, HERE / "vtk_frames.py", "--data", self.data, "--volume", self.args.volume]
        words += ["--lighting", column.lighting, "--mapper", column.mapper, "--images", self.prefix(column)]
        words += ["--warm-up", warm_up, "--frames", frames]
        try:
            result = run(words, self.vtk_environment(), f"{self.prefix(column)}_0000.png", self.args.timeout)
        except Failure as failure:
            raise Failure(f"{failure}\n  {WINDOW_HINT}") from None
        return result, json.loads(result.output.strip().splitlines()[-1])

    def tyndall_environment(self):
        return tyndall_frames.environment(self.software) | {"XDG_RUNTIME_DIR": self.runtime_dir}

    def frame_cost(self, column):
        """One turn: seconds of CPU per frame, and to the first PNG."""
        warm_up, frames = setting.WARM_UP_FRAMES, self.args.frames
        if not column.mapper:
            return tyndall_frames.cpu_per_frame(
                self.tyndall,
                self.scenes[column.scene()],
                self.prefix(column),
                warm_up,
                frames,
                self.tyndall_environment(),
                self.args.timeout,
            )
        result, facts = self.vtk(column, warm_up, frames)
        return facts | {"first_png_s": result.first_png_s}

    def startup_cost(self, column):
        """One turn: a process that draws one frame, writes one PNG and ends."""
        if column.mapper:
            result, facts = self.vtk(column, 0, 1)
        else:
            scene, prefix = self.scenes[column.scene()], self.prefix(column)
            env = self.tyndall_environment()
            result, facts = tyndall_frames.first_image(self.tyndall, scene, prefix, env, self.args.timeout), {}
        if result.first_png_s is None:
            raise Failure(f"{column.title} ended well but left no whole PNG")
        return facts | {"first_png_s": result.first_png_s, "exit_s": result.wall_s, "cpu_s": [result.cpu_s]}

    def rounds(self, columns, turn):
        turns = {c.key: [] for c in columns}
        for number in range(1, self.args.rounds + 1):
            for column in columns:
                say(f"round {number} of {self.args.rounds}: {column.title}")
                turns[column.key].append(turn(column))
        return turns


def load_remarks(load):
    if load <= 0.5 * os.cpu_count():
        return []
    return ["the machine was busy when this began. CPU seconds suffer less than wall seconds, but they suffer: "
            "differences under 30 % are ties."]


def say(text):
    print(text, file=sys.stderr, flush=True)


def main():
    args = arguments()
    try:
        columns = chosen_columns(args.columns)
        enter_venv(args.out / "venv")
        import report  # needs the venv's numpy

        startup = args.columns == "startup"
        remarks = make_volumes(args.out / "data")
        with tempfile.TemporaryDirectory() as runtime_dir:
            bench = Bench(args, columns, runtime_dir)
            load_before = os.getloadavg()
            turns = bench.rounds(columns, bench.startup_cost if startup else bench.frame_cost)
        write = report.write_startup if startup else report.write_frames
        known = bench.facts() | {"load average": f"{load_before[0]:.1f} before, {os.getloadavg()[0]:.1f} after"}
        remarks += load_remarks(load_before[0])
        print(write(args, columns, turns, remarks, known))
    except Failure as failure:
        sys.exit(f"compare.py: {failure}")
    except KeyboardInterrupt:
        sys.exit("compare.py: stopped")


if __name__ == "__main__":
    main()
