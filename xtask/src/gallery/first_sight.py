"""Draws files with F3D's own defaults: first_sight.py WIDTH HEIGHT INPUT OUTPUT [INPUT OUTPUT ...]

One file at a time in a process of its own, so that one that F3D cannot open takes no other with it. Needs the `f3d` wheel.
"""

import multiprocessing
import sys


def draw(width, height, source, picture):
    import f3d

    f3d.Log.set_verbose_level(f3d.Log.QUIET)
    engine = f3d.Engine.create(True)
    engine.window.size = width, height
    engine.scene.add(source)
    engine.window.render_to_image().save(picture)


if __name__ == "__main__":
    width, height = int(sys.argv[1]), int(sys.argv[2])
    for source, picture in zip(sys.argv[3::2], sys.argv[4::2]):
        process = multiprocessing.Process(target=draw, args=(width, height, source, picture))
        process.start()
        process.join(120)
        process.kill()
