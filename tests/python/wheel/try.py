"""What a fresh installation does: states, pictures, films, figures, pages. Prints checksums, which are those of any other."""

import hashlib
import os
import pickle
import sys
import tempfile

import numpy
import obscura

os.chdir(tempfile.mkdtemp())


def sum_of(what) -> str:
    return hashlib.sha256(bytes(what)).hexdigest()[:16]


for path in sys.argv[1:]:
    scene = obscura.Scene(path)
    scene.duration = 0.5
    world = scene.world()
    world.step(100)
    frame = scene.frame(0.4, size=(320, 180))
    frame.save("frame.png")
    print(scene.name, world.hash, sum_of(frame.array.tobytes()))
    for name in ("film.mp4", "film.gif", "film.webm"):
        scene.render(name, size=(160, 90), fps=30, end=0.2)
        print(name, sum_of(open(name, "rb").read()))
    print("page", scene.page(size=(160, 90), end=0.2).startswith("<!doctype html>"))
    assert pickle.loads(pickle.dumps(scene)) == scene

scene = obscura.Scene(room={"size": [4, 2.25]}, ball=[{"name": "ball", "radius": 0.2, "position": [1, 1]}])
scene.add_force(lambda stage: numpy.ones_like(stage.positions), "wind")
world = scene.world()
world.step(100)
print("force", world.hash, "figure", sum_of(obscura.Scene(sys.argv[1]).picture(0.2).svg.encode()))
print("pdf", obscura.Scene(sys.argv[1]).render("pages.pdf", size=(160, 90), fps=10, end=0.2))
