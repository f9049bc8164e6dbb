"""Turns the measurements into report.md, report.json and the comparison images."""

import itertools
import json
import os
import platform
import statistics
from pathlib import Path

import numpy as np
from PIL import Image

import setting
from processes import Failure

AMPLIFICATION = 8  # of the difference images, so that a difference of one step can be seen
LIGHTINGS = {"ea": "emission-absorption", "phong": "Phong", "scatter": "scattered light"}


# --- figures ----------------------------------------------------------------------------------------------------------


def spread(values, digits=2):
    middle = f"{statistics.median(values):.{digits}f}"
    return middle if len(values) == 1 else f"{middle} [{min(values):.{digits}f}-{max(values):.{digits}f}]"


def cpu_by_round(turns):
    """One figure per turn: the median of its frames."""
    return [statistics.median(turn["cpu_s"]) for turn in turns]


def delivered_by_round(turns):
    """The same with a PNG on disk per frame, which Tyndall's figure has in it already."""
    return [cpu + turn.get("save_png_cpu_s", 0.0) for cpu, turn in zip(cpu_by_round(turns), turns)]


def best_vtk(columns, lighting, figures):
    rivals = [statistics.median(figures[c.key]) for c in columns if c.mapper and c.lighting == lighting]
    return min(rivals, default=None)


def ratio(values, best):
    return "-" if best is None else f"{statistics.median(values) / best:.2f}"


def table(head, rows):
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def frame_table(columns, turns):
    drawn = {c.key: cpu_by_round(turns[c.key]) for c in columns}
    delivered = {c.key: delivered_by_round(turns[c.key]) for c in columns}
    rows = []
    for c in columns:
        rows.append(
            [
                c.title,
                spread(drawn[c.key]) + ("" if c.mapper else " (with PNG)"),
                ratio(drawn[c.key], best_vtk(columns, c.lighting, drawn)),
                spread(delivered[c.key]),
                ratio(delivered[c.key], best_vtk(columns, c.lighting, delivered)),
                first_png(turns[c.key]),
            ]
        )
    head = ["column", "CPU s/frame", "x best VTK", "CPU s/frame with PNG", "x best VTK with PNG", "start to first PNG, wall s"]
    return table(head, rows)


def first_png(turns):
    seen = [turn["first_png_s"] for turn in turns if turn["first_png_s"] is not None]
    return spread(seen) if seen else "-"


def startup_table(columns, turns):
    rows = []
    for c in columns:
        own = turns[c.key]
        exits, cpu = [t["exit_s"] for t in own], [t["cpu_s"][0] for t in own]
        rows.append([c.title, first_png(own), spread(exits), spread(cpu)])
    return table(["column", "start to first PNG, wall s", "start to exit, wall s", "CPU s of the process"], rows)


# --- images -----------------------------------------------------------------------------------------------------------


def read(path):
    try:
        pixels = np.asarray(Image.open(path).convert("RGB"), dtype=np.int16)
    except OSError as error:
        raise Failure(f"cannot read {path}: {error}") from None
    width, height = setting.SIZE
    if pixels.shape != (height, width, 3):
        raise Failure(f"{path} is {pixels.shape[1]}x{pixels.shape[0]}, asked for was {width}x{height}")
    return pixels


def rms(a, b):
    return float(np.sqrt(np.mean((a - b).astype(np.float64) ** 2)))


def write_pair(folder, stem, a, b):
    """a, b and their absolute difference, amplified, in a row."""
    difference = np.abs(a - b)
    shown = np.clip(difference * AMPLIFICATION, 0, 255)
    path = folder / f"{stem}.png"
    Image.fromarray(np.concatenate([a, b, shown], axis=1).astype(np.uint8)).save(path)
    Image.fromarray(difference.astype(np.uint8)).save(folder / f"{stem}_difference.png")
    return path


def compare_images(args, columns, frames):
    """Every pair of columns with the same lighting, at the first and at the last frame."""
    folder, results = args.out / "images", []
    for frame, lighting in itertools.product(frames, LIGHTINGS):
        same = [c for c in columns if c.lighting == lighting and not c.light_turns]
        pixels = {c.key: read(folder / f"{args.volume}_{c.key}_{frame:04}.png") for c in same}
        for a, b in itertools.combinations(same, 2):
            x, y = pixels[a.key], pixels[b.key]
            sheet = write_pair(folder, f"compare_{args.volume}_{a.key}_{b.key}_{frame:04}", x, y)
            results.append(
                {
                    "a": a.title,
                    "b": b.title,
                    "frame": frame,
                    "rms": round(rms(x, y), 3),
                    "largest": int(np.abs(x - y).max()),
                    "sheet": str(sheet.relative_to(args.out)),
                }
            )
    return results


def image_table(results):
    rows = [
        [r["a"], r["b"], str(r["frame"]), f"{r['rms']:.2f}", str(r["largest"]), f"[image]({r['sheet']})"] for r in results
    ]
    return table(["left", "middle", "frame", "8-bit RMS difference", "largest", f"right: difference x {AMPLIFICATION}"], rows)


# --- the report -------------------------------------------------------------------------------------------------------


def processor():
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        return next(line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or "unknown processor"


def facts(args, turns, known):
    first_vtk = next((own[0] for own in turns.values() if "vtk" in own[0]), {})
    return {
        "machine": f"{processor()}, {os.cpu_count()} threads, {platform.system()} {platform.release()}",
        "VTK": "{vtk}, {window}, {gl_renderer}".format(**first_vtk) if first_vtk else "not run",
        **known,
        "volume": f"{args.volume} at {setting.SIZE[0]}x{setting.SIZE[1]}, step {setting.STEP:g}",
        "rounds": f"{args.rounds}, median [least-most] over rounds",
    }


def page(title, facts_, remarks, sections):
    listed = [f"- {name}: {value}" for name, value in facts_.items()] + [f"- **Note:** {r}" for r in remarks]
    return "\n\n".join([f"# {title}", "\n".join(listed), *sections]) + "\n"


def remarks_on_spread(columns, turns):
    """A difference of two whole processes can be lost in their noise: say where it was."""
    lost = [c.title for c in columns if not c.mapper and min(cpu_by_round(turns[c.key])) <= 0]
    return [f"{title}: a run with more frames cost no more than one with fewer; raise --frames" for title in lost]


def write_frames(args, columns, turns, remarks, known):
    frames = sorted({0, setting.WARM_UP_FRAMES + args.frames - 1})
    remarks = [*remarks, *remarks_on_spread(columns, turns)]
    known = facts(args, turns, known)
    known["frames"] = f"{args.frames} timed per turn after {setting.WARM_UP_FRAMES} to warm up"
    images = compare_images(args, columns, frames)
    note = (
        "CPU seconds count all threads of the process. Tyndall's include encoding and writing one PNG per frame; VTK's do not, "
        "and the columns *with PNG* add what reading back and writing one costs VTK. `README.md` beside the script says what "
        "differs between the programs."
    )
    sections = [frame_table(columns, turns), note, *([image_table(images)] if images else [])]
    text = page("Tyndall and VTK, frame by frame", known, remarks, sections)
    return save(args, "report", text, {"facts": known, "remarks": remarks, "turns": turns, "images": images})


def write_startup(args, columns, turns, remarks, known):
    known = facts(args, turns, known)
    note = (
        "One process, one frame, one PNG. The first round may find the disk cache and the drivers' shader caches cold: "
        "it is in the spread, and report JSON lists the rounds in order."
    )
    text = page("Tyndall and VTK, start to first image", known, remarks, [startup_table(columns, turns), note])
    return save(args, "startup", text, {"facts": known, "remarks": remarks, "turns": turns})


def save(args, stem, text, data):
    (args.out / f"{stem}.md").write_text(text)
    (args.out / f"{stem}.json").write_text(json.dumps(data, indent=2) + "\n")
    return f"{text}\n{args.out / stem}.md and .json"
