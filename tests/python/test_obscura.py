"""The Python module: scenes, worlds, forces, frames and films. Run by tests/python/check."""

import copy
import functools
import gc
import inspect
import json
import os
import pickle
import re
import subprocess
import sys
import tomllib
import weakref
from pathlib import Path

import numpy as np
import pytest

import obscura

ROOT = Path(__file__).resolve().parents[2]
SCENES = sorted((ROOT / "scenes").glob("*.toml"))
PROGRAM = os.environ["OBSCURA_PROGRAM"]
SMALL = {"size": (160, 90), "fps": 30}


def room(**more):
    return obscura.Scene({"room": {"size": [4, 4], "walls": "none", "gravity": [0, 0]}, "physics": {"rate": 100},
                          "ball": [{"name": "b", "radius": 0.1, "mass": 2, "position": [3, 2], "velocity": [0, 1]}], **more})


def spring(stage):
    return -8 * (stage.positions - 2)


# --- scenes


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_keys_of_a_shipped_scene_are_the_same_scene(path):
    scene = obscura.Scene(path)
    again = obscura.Scene(scene._built().keys())
    assert again.hash == scene.hash
    a, b = scene.world(), again.world()
    a.step(3), b.step(3)
    assert a.hash == b.hash


def test_every_key_of_the_schema_is_an_attribute_that_says_the_same_as_text():
    def walk(keys, path):
        for name, node in keys.items():
            yield path + [name], node
            yield from walk(obscura.keys.properties(node), path + [name])

    seen = whole = 0
    for path, node in walk(obscura.schema()["properties"], []):
        for example in node.get("examples", []):
            value, section, text = example, scene_section(path), json_toml(example)
            scene, owner = section
            setattr(owner, path[-1], value)
            made, there = obscura._obscura.toml(scene._data), nested(path, text)
            assert tomllib.loads(made) == tomllib.loads(there), path
            seen += 1
            try:
                wanted = obscura.Scene.parse(there).hash
            except obscura.SceneError:
                continue
            assert scene.hash == wanted, path
            whole += 1
    assert seen > 400 and whole > 100


def scene_section(path):
    scene = obscura.Scene()
    owner = scene
    for name in path[:-1]:
        owner = getattr(owner, name)
        if isinstance(owner, obscura.keys.Kind):
            owner = owner.add()
    return scene, owner


def nested(path, text):
    keys = obscura.schema()["properties"]
    listed = []
    for name in path[:-1]:
        listed.append(obscura.keys.is_list(keys[name]))
        keys = obscura.keys.properties(keys[name])
    line = f"{path[-1]} = {text}"
    for name, many in zip(reversed(path[:-1]), reversed(listed)):
        line = f"{name} = [{{ {line} }}]" if many else f"{name} = {{ {line} }}"
    return line


def json_toml(value):
    if isinstance(value, dict):
        return "{ " + ", ".join(f'"{key}" = {json_toml(each)}' for key, each in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(json_toml(each) for each in value) + "]"
    return json.dumps(value, ensure_ascii=False)


def test_keys_are_attributes_and_wrong_ones_are_named():
    scene = room()
    scene.room.gravity = [0, -1]
    assert scene.room.gravity == [0, -1]
    assert scene.ball["b"].mass == 2 and scene.ball[0].name == "b" and len(scene.ball) == 1
    scene.ball.add(name="c", radius=0.1, position=[1, 1])
    assert [body.name for body in scene.bodies] == ["b", "c"]
    assert scene.physics.rate == 100 and "gravity" in dir(scene.room)
    with pytest.raises(AttributeError, match="did you mean 'gravity'"):
        scene.room.gravitty = 1
    with pytest.raises(AttributeError, match="did you mean 'radius'"):
        scene.ball.add(radios=1)
    with pytest.raises(AttributeError):
        obscura.Scene({"rooom": {}})
    del scene.ball["c"]
    assert len(scene.bodies) == 1


def test_a_table_or_an_array_changed_in_place_changes_the_scene():
    scene = room(constants={"k": 1}, force=[{"components": ["k", 0]}])
    scene.constants["k"] = 5
    assert scene.constants == {"k": 5}
    world = scene.world()
    world.step_to(1)
    assert abs(world.velocities[0, 0] - 2.5) < 1e-9
    scene.constants.update(k=7, other=[1, 2])
    scene.constants["other"][0] = 3
    assert scene.constants == {"k": 7, "other": [3, 2]} and copy.deepcopy(scene.constants) == scene.constants
    scene.ball[0].velocity = np.array([1.0, 0.0])
    scene.ball[0].velocity[0] = 3
    assert scene.ball[0].velocity == [3, 0]
    scene.film.speed = [{"time": 0}, {"time": 1, "speed": 0.5}]
    before = obscura._obscura.toml(scene._data)
    scene.film.speed[1]["speed"] = 0.1
    assert obscura._obscura.toml(scene._data) != before


def test_what_was_given_may_be_changed_afterwards():
    scene, v = room(), [0.0, 0.0]
    for i in range(3):
        v[0] = float(i)
        scene.ball.add(radius=0.1, position=[1, 1 + i / 2], velocity=v)
    assert [ball.velocity[0] for ball in list(scene.ball)[1:]] == [0, 1, 2]


def test_a_list_changed_in_place_changes_the_scene():
    for scene in (room(), obscura.Scene.parse(room().text)):
        before = scene.hash
        scene.ball[0].position[1] = 1.0
        assert scene.hash != before and scene.ball[0].position == [3, 1.0]
        assert scene.world().positions[0].tolist() == [3, 1]
        scene.ball[0].position += [1]
        assert scene.ball[0].position == [3, 1.0, 1]
    with pytest.raises(AttributeError, match=r"scene\.ball\[0\]\.elasticity"):
        room().ball.elasticity = 0.5
    with pytest.raises(AttributeError, match="did you mean 'velocities'"):
        room().world().velocity = [[1, 0]]


def test_what_is_no_longer_in_the_scene_changes_nothing_without_a_word():
    scene = room()
    old = scene.ball[0].position
    scene.ball[0].position = [1, 1]
    with pytest.raises(obscura.UsageError, match="replaced: ask for it again, as scene.ball.0..position"):
        old[0] = 3.5
    assert scene.ball[0].position == [1, 1]
    gone = scene.ball.add(name="gone", radius=0.1, position=[1, 3])
    kept = scene.ball.add(name="kept", radius=0.1, position=[3, 3])
    del scene.ball["gone"]
    with pytest.raises(obscura.UsageError, match="no longer in the scene"):
        gone.radius = 0.2
    kept.radius = 0.2
    assert scene.ball["kept"].radius == 0.2 and scene.ball[0].radius == 0.1
    for wrong, told in ((lambda: scene.ball.radius, r"scene\.ball\[0\]\.radius"), (lambda: scene.ball.append({}), "scene.ball.add"),
                        (lambda: scene.ball[0:1], "by its number or name")):
        with pytest.raises((AttributeError, TypeError), match=told):
            wrong()
    scene.room = 5
    assert repr(scene.room) == "<room: {}>"
    with pytest.raises(obscura.SceneError, match="expected a table, got 5"):
        scene.world()


def test_a_class_of_worlds_has_attributes_of_its_own():
    class Task(obscura.World):
        def __init__(self, scene):
            super().__init__(scene)
            self.goal = 3
            self.reward = self.state = self.seed = 0
            self.times = []

    task = Task(room())
    task.step()
    assert task.goal == 3 and task.steps == 1
    with pytest.raises(AttributeError, match="did you mean 'velocities'"):
        task.velocity = 1
    with pytest.raises(AttributeError, match="a world has no 'goal'"):
        room().world().goal = 3


def test_copies_and_pickles_keep_what_was_read(tmp_path):
    (tmp_path / "a.toml").write_text(room().text)
    scene = obscura.Scene(tmp_path / "a.toml")
    world = scene.world()
    world.step(5)
    kept, going = pickle.dumps(scene), pickle.dumps(world)
    (tmp_path / "a.toml").unlink()
    assert pickle.loads(kept) == scene == scene.copy() == copy.copy(scene) == copy.deepcopy(scene)
    scene.physics.rate = 50
    other = pickle.loads(going)
    other.step(5), world.step(5)
    assert other.hash == world.hash and world.scene.physics.rate == 100
    changed = copy.copy(scene)
    changed.ball[0].radius = 0.3
    changed.add_force(spring, "spring")
    changed.add_force(spring, "spring")
    assert scene.ball[0].radius == 0.1 and scene.world().hash != changed.world().hash
    changed.remove_force("spring")
    assert changed != scene and changed._forces == []


def test_work_of_other_threads_ends_with_python(tmp_path):
    (tmp_path / "end.py").write_text(f"""
import obscura, threading
scene = obscura.Scene({str(ROOT / "scenes/room.toml")!r})
movie = obscura.Movie({str(tmp_path / "open.mp4")!r}, size=(16, 16), fps=10)

at_work = threading.Event()

def work(world=scene.world()):
    while True:
        world.step(10)
        at_work.set()

threading.Thread(target=work, daemon=True).start()
at_work.wait()
""")
    assert subprocess.run([sys.executable, tmp_path / "end.py"], capture_output=True, timeout=60).returncode == 0
    assert sorted(os.listdir(tmp_path)) == ["end.py"]


def test_what_does_not_fit_is_an_error(tmp_path):
    with pytest.raises(ValueError, match="0 to 255"):
        with obscura.Movie(tmp_path / "a.mp4", size=(16, 16), fps=10) as movie:
            movie.add(np.full((16, 16, 3), 300))
    with pytest.raises(obscura.UsageError, match="is a PNG"):
        room().frame(**SMALL).save(tmp_path / "a.jpg")
    fixed = room(box=[{"name": "plate", "size": [1, 1], "position": [1, 1], "fixed": True}]).world()
    with pytest.raises(obscura.UsageError, match="plate is fixed"):
        fixed.velocities = fixed.velocities + [1, 0]
    endless = []
    endless.append(endless)
    scene = room()
    scene.ball[0].__dict__["_data"]["position"] = endless
    with pytest.raises(ValueError, match="nested too deep"):
        obscura._obscura.toml(scene._data)
    found = room().sweep({"b.fixed": [True, False], "b.velocity": [(0, 1), np.array([0.0, 0.0])]}, "b.position.y@1")
    assert list(found["b.fixed"]) == ["true", "true", "false", "false"] and list(found["trouble"][2:]) == ["", ""]


def test_faults_have_their_place():
    with pytest.raises(obscura.SceneError) as found:
        obscura.Scene.parse("[room]\nsize = [4, 4]\n[[ball]]\nradius = -1\nposition = [1, 1]\n", "a.toml")
    assert (found.value.file, found.value.line, found.value.column) == ("a.toml", 4, 10)
    scene = room()
    scene.ball[0].radius = -1
    with pytest.raises(obscura.SceneError) as found:
        scene.world()
    assert found.value.key == "ball[0].radius" and isinstance(found.value, ValueError)
    assert pickle.loads(pickle.dumps(found.value)).key == "ball[0].radius"
    with pytest.raises(TypeError):
        obscura.Scene(room={"size": object()}).hash


def test_a_file_keeps_its_lines_until_a_key_is_changed(tmp_path):
    path = tmp_path / "a.toml"
    path.write_text("# mine\n[room]\nsize = [4, 4]\n")
    scene = obscura.Scene(path, sets=["duration=2"])
    assert scene.text.startswith("# mine") and scene.duration == 2
    scene.duration = 3
    assert obscura.Scene(path, sets=["duration=3"]) == scene


def test_scenes_worlds_and_states_pickle():
    for scene in (room(), obscura.Scene(SCENES[0]), obscura.Scene.parse("[room]\nsize = [4, 4]\n")):
        again = pickle.loads(pickle.dumps(scene))
        assert again == scene and copy.deepcopy(scene) == scene
    scene = room()
    scene.add_force(spring)
    world = scene.world()
    world.step(30)
    other = pickle.loads(pickle.dumps(world))
    assert other.hash == world.hash and other.save() == world.save()
    world.step(30), other.step(30)
    assert other.hash == world.hash


def test_what_worlds_and_renderers_give_pickles():
    scene = obscura.Scene.parse("""
        [room]
        size = [4, 4]
        [[ball]]
        name = "ball"
        radius = 0.2
        elasticity = 0
        position = [2, 1]
        [[when]]
        touches = ["ball", "floor"]
        name = "down"
        do = [{ mark = "down" }]
    """)
    world = scene.world()
    world.contact_changes()
    world.step_to(2)
    began, _ = world.contact_changes()
    frame = next(iter(obscura.Renderer(scene, size=(160, 90))))
    for value in (*world.contacts, *began, *world.events, world.energies, frame):
        other = pickle.loads(pickle.dumps(value))
        for name in dir(type(value)):
            if name.startswith("_") or callable(getattr(value, name)):
                continue
            assert np.array_equal(getattr(other, name), getattr(value, name)), name
    assert world.contacts and began and world.events


def test_things_are_looked_for_by_name():
    scene = room()
    names = [ball.name for ball in scene.ball]
    assert names and all(name in scene.ball for name in names) and "nobody" not in scene.ball


# --- worlds


def test_columns_share_the_memory_of_the_state():
    world = room().world()
    positions = world.positions
    address = positions.__array_interface__["data"][0]
    assert positions.shape == (1, 2) and not positions.flags.writeable
    world.step(100)
    assert np.allclose(positions, [[3, 3]]) and world.positions.__array_interface__["data"][0] == address
    with pytest.raises(ValueError):
        positions[0, 0] = 1
    del world
    assert np.allclose(positions, [[3, 3]])  # it keeps its world


def test_states_are_saved_restored_and_set():
    world = room().world()
    state = world.save()
    world.step(10)
    end = world.hash
    world.restore(state)
    world.step(10)
    assert world.hash == end
    world.velocities = [[1, 0]]
    world.step(100)
    assert np.allclose(world.positions, [[4, 2.1]])
    with pytest.raises(obscura.UsageError):
        world.velocities = [1, 2, 3]
    with pytest.raises(obscura.UsageError, match="did you mean 'b'"):
        world.body("bb")
    assert world.read("b.velocity.x") == 1 and world.energies.kinetic == 1


def test_a_body_is_not_set_outside_the_room():
    scene = obscura.Scene(room={"size": [4, 4]}, ball=[{"name": "b", "radius": 0.1, "position": [2, 2]}])
    world = scene.world()
    for place, wall in (([100, 2], "96.1 m beyond the right wall"), ([2, -5], "the floor"), ([0.05, 2], "the left wall")):
        with pytest.raises(obscura.UsageError, match=f"b would be outside the room: .*{wall}"):
            world.positions = [place]
    assert world.positions.tolist() == [[2, 2]]
    world.positions = [[0.1, 3.9]]  # in a corner
    world.step()


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_what_a_run_has_come_to_can_be_set(path):
    scene = obscura.Scene(path)
    there, world = scene.world(), scene.world()
    try:
        there.step_to(1)
    except obscura.RunError:
        pass
    for name in ("positions", "turns", "velocities", "spins"):
        try:
            setattr(world, name, getattr(there, name))
        except obscura.UsageError as error:
            assert "outside" not in str(error)
    try:
        world.step()
    except obscura.RunError as error:
        assert "outside" not in str(error)


def test_contacts_and_events():
    scene = obscura.Scene({"room": {"size": [4, 4]}, "physics": {"collision": "event"},
                           "ball": [{"name": "ball", "radius": 0.1, "position": [2, 1], "elasticity": 0.5}],
                           "when": [{"name": "hit", "touches": ["ball", "floor"], "do": [{"mark": "hit"}]}]})
    world = scene.world()
    began = []
    while world.time < 0.6:
        world.step()
        began += world.contact_changes()[0]
    assert began and began[0].body == 0 and began[0].other == -1
    assert abs(world.events[0].time - np.sqrt(2 * 0.9 / 9.81)) < 1e-9


# --- forces


def error_at(rate):
    scene = room()
    scene.physics.rate = rate
    scene.add_force(spring)
    world = scene.world()
    world.step_to(1)
    return np.hypot(*(world.positions[0] - [2 + np.cos(2 * world.time), 2 + np.sin(2 * world.time) / 2]))


def test_a_force_keeps_order_four():
    assert abs(np.log2(error_at(20) / error_at(40)) - 4) < 0.1


def test_a_force_on_a_thousand_bodies_is_one_call_a_stage():
    scene = obscura.Scene({"room": {"size": [40, 40], "walls": "none", "gravity": [0, 0]}, "physics": {"rate": 100},
                           "ball": [{"name": "b", "radius": 0.1, "position": [1, 1],
                                     "copies": {"count": [40, 25], "offset": [[0.9, 0], [0, 1.5]]}}]})
    calls = []
    scene.add_force(lambda stage: calls.append(len(stage.positions)) or 0 * stage.positions, "count")
    world = scene.world()
    calls.clear()
    world.step(5)
    # four stages, and two points for the work
    assert calls == [1000] * 30


def test_columns_for_rows_are_refused():
    scene = room()
    scene.ball.add(name="c", radius=0.1, position=[1, 1])
    scene.ball.add(name="d", radius=0.1, position=[1, 3])
    world = scene.world()
    with pytest.raises(obscura.UsageError, match="2 x 3, expected 3 x 2"):
        world.velocities = np.ones((2, 3))
    world.velocities = np.ones((3, 2))
    scene.add_force(lambda stage: stage.positions.T, "columns")
    with pytest.raises(ValueError, match="2 x 3, expected 3 x 2"):
        scene.world().step()


def test_a_world_refuses_a_force_and_a_thread_that_ask_it_at_work():
    scene, its = room(), []
    scene.add_force(lambda stage: [world.step() for world in its], "itself")
    its.append(scene.world())
    with pytest.raises(obscura.UsageError, match="at work"):
        its[0].step()
    program = """
import obscura, sys, threading
scene = obscura.Scene(sys.argv[1])
world, renderer = scene.world(), scene.frames(size=(160, 90))
def ask():
    for _ in range(100):
        try:
            world.step()
            world.contacts
            next(renderer)
        except obscura.UsageError:
            pass
threads = [threading.Thread(target=ask) for _ in range(4)]
for thread in threads: thread.start()
for thread in threads: thread.join()
"""
    run = subprocess.run([sys.executable, "-c", program, ROOT / "scenes/room.toml"], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr


def test_a_force_may_fill_its_arrays_and_give_torques():
    scene = obscura.Scene({"room": {"size": [4, 4], "walls": "none", "gravity": [0, 0]},
                           "box": [{"name": "box", "size": [1, 1], "mass": 6, "position": [2, 2]}]})
    scene.add_force(lambda stage: (0 * stage.positions, np.ones(1)), "twist")

    def push(stage):
        stage.forces[:, 0] = 6

    scene.add_force(push)
    world = scene.world()
    world.step_to(1)
    assert abs(world.spins[0] - 1) < 1e-9 and abs(world.velocities[0, 0] - 1) < 1e-9


@pytest.mark.parametrize("answer", [
    lambda stage: None,
    lambda stage: stage.forces,
    lambda stage: stage.forces[:],
    lambda stage: (stage.forces, stage.torques),
    lambda stage: (stage.forces[::1], np.asarray(stage.torques)),
    lambda stage: (stage.forces, np.zeros(1)),
])
def test_what_a_force_fills_and_returns_counts_once(answer):
    scene = obscura.Scene({"room": {"size": [4, 4], "walls": "none", "gravity": [0, 0]},
                           "box": [{"name": "box", "size": [1, 1], "mass": 6, "position": [2, 2]}]})

    def push(stage):
        stage.forces[:, 0], stage.torques[:] = 6, 1
        return answer(stage)

    scene.add_force(push)
    world = scene.world()
    world.step_to(1)
    assert abs(world.spins[0] - 1) < 1e-9 and abs(world.velocities[0, 0] - 1) < 1e-9


def test_a_force_may_add_to_its_arrays():
    scene = room()

    def push(stage):
        stage.forces += [4, 0]
        stage.forces += [2, 0]

    scene.add_force(push)
    world = scene.world()
    world.step_to(1)
    assert abs(world.velocities[0, 0] - 3) < 1e-9
    scene.add_force(lambda stage: setattr(stage, "forces", np.ones(3)), "wrong")
    with pytest.raises(ValueError, match="an array of 3, expected 1 x 2"):
        scene.world().step()


def test_the_arrays_of_a_stage_cannot_be_moved():
    scene = room()
    scene.add_force(lambda stage: stage.forces.resize((10000, 2), refcheck=False), "moves")
    with pytest.raises(ValueError, match="own"):
        scene.world().step()


def test_what_a_world_runs_is_not_changed_by_its_scene():
    world = room().world()
    world.scene.room.gravity = [0, -1]
    assert world.scene.room.gravity == [0, 0] and copy.copy(world).scene.room.gravity == [0, 0]


def test_a_figure_that_cannot_be_written_leaves_the_old_one(tmp_path):
    figure = obscura.Figure("<svg/>")
    figure.save(tmp_path / "a.svg")
    assert (tmp_path / "a.svg").read_text() == "<svg/>" and os.listdir(tmp_path) == ["a.svg"]
    with pytest.raises(obscura.FileError, match="there/a.svg"):
        figure.save(tmp_path / "there" / "a.svg")


def test_a_force_that_runs_out_of_values_does_not_end_the_film():
    scene, values = room(), iter([1.0] * 50)
    scene.add_force(lambda stage: np.full((1, 2), next(values)), "controls")
    with pytest.raises(RuntimeError, match="StopIteration"):
        for _ in scene.frames(**SMALL):
            pass


def test_what_a_force_raises_comes_out_and_the_step_is_not_taken():
    scene = room()

    def moody(stage):
        if stage.time > 0.1:
            raise KeyError("enough")

    scene.add_force(moody)
    world = scene.world()
    with pytest.raises(KeyError, match="enough"):
        world.step(100)
    assert world.steps == 10
    scene = room()
    scene.add_force(lambda stage: np.ones(7), "wrong")
    with pytest.raises(ValueError, match="expected 2"):
        scene.world().step()
    for answer in ("two", [[1, 2], [3]], object()):
        scene = room()
        scene.add_force(lambda stage: answer, "text")
        with pytest.raises(TypeError, match="no array of numbers"):
            scene.world().step()
    scene = room()
    scene.add_force(lambda stage: np.nan * stage.positions, "hole")
    with pytest.raises(obscura.RunError) as found:
        scene.world().step()
    assert found.value.body == "b" and found.value.quantity == "force"


def test_a_second_force_without_a_name_of_its_own_does_not_replace_the_first():
    def push(f):
        def made(stage):
            return np.full((1, 2), f)
        return made

    class Field:
        def pull(self, stage):
            return 0 * stage.positions

    for first, second in ((lambda stage: [[1, 0]], lambda stage: [[0, 1]]), (push(1), push(2)), (Field().pull, Field().pull),
                          (functools.partial(spring), functools.partial(spring))):
        scene = room()
        scene.add_force(first)
        scene.add_force(first)
        with pytest.raises(obscura.UsageError, match="already: add_force.force, name=...."):
            scene.add_force(second)
        scene.add_force(second, "second")
        assert [force for _, force in scene._forces] == [first, second]
    # a cell of a notebook that runs again
    for _ in range(2):
        exec("def again(stage): return 0 * stage.positions", here := {})
        scene.add_force(here["again"])
    assert len(scene._forces) == 3


def test_a_force_that_refers_to_its_world_is_collected():
    def made():
        scene, own = room(), []
        scene.add_force(lambda stage: len(own) * 0 * stage.positions, "own")
        scene.add_force(spring)
        world, renderer = scene.world(), scene.frames(**SMALL)
        own.extend([scene, world, renderer, scene.copy()])
        world.step()
        renderer.draw(world)
        return [weakref.ref(each) for each in own]

    gc.collect()
    kept = made()
    gc.collect()
    assert [each() for each in kept] == [None] * 4


def test_a_force_lives_as_long_as_what_calls_it():
    calls = []
    scene = room()
    scene.add_force(lambda stage: calls.append(1), "counted")
    world, renderer = scene.world(), scene.frames(**SMALL)
    del scene
    gc.collect()
    before = len(calls)
    world.step()
    between = len(calls)
    next(renderer), next(renderer)
    assert before < between < len(calls)


def test_text_and_complex_numbers_are_no_columns():
    world = room().world()
    for wrong in ("abc", None, [[1, 2], [3]], np.array([["1", "2"]]), np.array([[1 + 1j, 2]])):
        with pytest.raises(TypeError, match="a column of 1 x 2: no array of numbers"):
            world.velocities = wrong
        scene = room()
        scene.add_force(lambda stage: (wrong, 0), "wrong")
        with pytest.raises(TypeError, match="a force returned forces: no array of numbers"):
            scene.world().step()
    scene = room()
    scene.add_force(lambda stage: (0.0, 1.0), "of one body")
    with pytest.raises(ValueError, match="returned 1 numbers of forces, expected 2: a tuple of two is forces and torques"):
        scene.world().step()
    world.velocities = np.array([[1, 2]], np.float32)[:, ::-1]
    assert world.velocities.tolist() == [[2, 1]]


# --- arguments


@pytest.mark.parametrize("name", ["Body", "Contact", "Energies", "Event", "Frame", "Movie", "Pair", "Renderer", "Scene", "Stage",
                                  "State", "World"])
def test_what_was_not_made_is_an_error_and_no_crash(name):
    program = f"""
import obscura
for of in (obscura, obscura._obscura):
    made, refused = of.{name}.__new__(of.{name}), 0
    for member in {{*dir(type(made))}} - set(dir(object)):
        try:
            found = getattr(made, member)
            for arguments in ((), (made,), (1,), ("a",), (None, None, None)):
                try:
                    found(*arguments)
                except SystemError:
                    raise SystemExit(1)
                except Exception as error:
                    refused += "was not made" in str(error)
        except SystemError:
            raise SystemExit(1)
        except Exception as error:
            refused += "was not made" in str(error)
    assert refused > 0
"""
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr


WRONG = {
    "world.step(1.5)": "whole number of steps.*not 1.5",
    "world.step('a')": "whole number of steps.*not 'a'",
    "world.step(10**30)": "whole number of steps",
    "world.step(1, 2)": "takes from 1 to 2 positional arguments",
    "world.step_to('1')": "number of seconds, not '1'",
    "world.body(0)": "name of a body, not 0",
    "world.read(0)": "takes a name, as 'energy.total', not 0",
    "world.restore(b'')": "what save\\(\\) gave",
    "obscura.World(scene, threads='2')": "threads is a whole number",
    "obscura.Scene(3)": "file's name, or keys as a dict",
    "obscura.Scene({3: 4})": "keys of a scene are words, not 3",
    "obscura.Scene('[room]\\nsize = [4, 4]\\n')": "Scene.parse\\(text\\)",
    "obscura.Scene.parse(Path('a.toml'))": "reads a file",
    "obscura.Scene.parse('', sets=[1])": "'sets' is a list of words",
    "scene.add_force(spring, name=3)": "name of a force is a word",
    "scene.frames(width=1.5)": "width is a whole number of pixels, not 1.5",
    "scene.frames(theme=3)": "theme is 'paper' or 'screen', not 3",
    "scene.frames(start='a')": "start is a number of seconds, not 'a'",
    "scene.frames(**SMALL).at('1')": "number of seconds, not '1'",
    "scene.frames(**SMALL).draw(scene)": "takes a World, not <Scene",
    "scene.still('a', 'b.png')": "number of seconds, not 'a'",
    "scene.render('a\\0.mp4')": "no zero in it",
    "scene.render(os.fsdecode(b'\\xff.mp4'))": "path is of UTF-8",
    "scene.picture('a')": "number of seconds",
    "obscura.Movie('a.mp4', scene)": "is of a Renderer",
    "obscura.Movie('a.mp4', size=(16, 16), fps=10, start=1)": "has no start: that is a renderer's",
    "scene.sweep('b.mass=1', 'energy.total')": "'vary' is a list",
    "scene.sweep({'b.mass': 1}, 'energy.total')": "b.mass: expected a list of values, not 1",
    "scene.sweep({'b.mass': [1]}, [3])": "'measure' is a list of words",
    "scene.sweep({'b.mass': [1]}, 'energy.total', jobs='a')": "jobs is a whole number",
}


@pytest.mark.parametrize("code", WRONG)
def test_a_wrong_argument_is_told_in_one_line(code):
    scene = room()
    with pytest.raises((TypeError, ValueError), match=WRONG[code]) as found:
        eval(code, globals(), {"scene": scene, "world": scene.world()})
    assert "\n" not in str(found.value) and "incompatible" not in str(found.value)


# --- pictures and films


def program(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)


def test_frames_are_the_pictures_of_the_program(tmp_path):
    path = ROOT / "scenes/room.toml"
    assert program("render", path, "--size", "160x90", "--fps", "30", "--frames", "0..3", "-o", tmp_path / "{frame:02}.png").returncode == 0
    scene = obscura.Scene(path)
    for frame, _ in zip(scene.frames(**SMALL), range(4)):
        frame.save(tmp_path / "own.png")
        assert compare(tmp_path / f"0{frame.number}.png", tmp_path / "own.png")
        assert frame.array.shape == (90, 160, 4) and np.asarray(frame).dtype == np.uint8
    assert len(scene.frames(**SMALL)) == 300
    scene.still(0.1, tmp_path / "still.png", **SMALL)
    assert program("render", path, "--size", "160x90", "--fps", "30", "--at", "0.1", "-o", tmp_path / "cli.png").returncode == 0
    assert (tmp_path / "still.png").read_bytes() == (tmp_path / "cli.png").read_bytes()


@pytest.mark.parametrize("scene", ["room", "slope", "crate", "top"])
@pytest.mark.parametrize("transparent", [False, True])
def test_arrays_are_the_pixels_of_the_programs_png(scene, transparent, tmp_path):
    path = ROOT / f"scenes/{scene}.toml"
    clear = ["--transparent"] if transparent else []
    made = program("render", path, "--size", "320x180", "--fps", "30", "--frames", "7..10", *clear, "-o", tmp_path / "{frame:02}.png")
    assert made.returncode == 0, made.stderr
    frames = list(obscura.Scene(path).frames(size=(320, 180), fps=30, end=0.4, transparent=transparent))
    for n in range(7, 11):
        assert frames[n].number == n
        assert np.array_equal(frames[n].array, decoded(tmp_path / f"{n:02}.png", (180, 320, 4))), n
    assert (frames[7].array[:, :, 3].min() < 255) == transparent
    assert len({frame.array.tobytes() for frame in frames[7:11]}) == 4  # each has its own


def decoded(path, shape):
    """The pixels of a PNG by another program than ours."""
    run = subprocess.run(["ffmpeg", "-v", "error", "-i", path, "-f", "rawvideo", "-pix_fmt", "rgba", "-"], capture_output=True, check=True)
    return np.frombuffer(run.stdout, np.uint8).reshape(shape)


def test_a_frame_keeps_its_pixels_and_the_memory_of_those_gone_is_used_again():
    renderer = obscura.Scene(ROOT / "scenes/room.toml").frames(**SMALL)
    first = next(renderer)
    kept, pixels = first.array, first.array.copy()
    del first
    places = set()
    for _ in range(20):
        places.add(next(renderer).array.__array_interface__["data"][0])
    del renderer
    assert np.array_equal(kept, pixels)
    assert len(places) < 5 and kept.__array_interface__["data"][0] not in places
    kept[0, 0] = 0  # it is its owner's alone


def test_a_frame_is_an_array_with_or_without_a_copy():
    frame = obscura.Scene(ROOT / "scenes/room.toml").frame(0, **SMALL)
    assert np.shares_memory(np.asarray(frame), frame.array) and np.asarray(frame, np.uint8).dtype == np.uint8
    assert np.shares_memory(frame.__array__(copy=False), frame.array)
    assert not np.shares_memory(frame.__array__(copy=True), frame.array)
    assert np.asarray(frame, float).dtype == float
    with pytest.raises(ValueError):
        frame.__array__(float, copy=False)


def compare(a, b):
    return program("compare", a, b).returncode == 0


def test_films_movies_pages_figures_and_sweeps(tmp_path):
    path = ROOT / "scenes/room.toml"
    scene = obscura.Scene(path)
    scene.render(tmp_path / "a.mp4", end=0.3, **SMALL)
    assert program("render", path, "--size", "160x90", "--fps", "30", "--to", "0.3", "-o", tmp_path / "b.mp4").returncode == 0
    assert (tmp_path / "a.mp4").read_bytes() == (tmp_path / "b.mp4").read_bytes()
    renderer = scene.frames(**SMALL)
    world = scene.world()
    with obscura.Movie(tmp_path / "c.mp4", renderer) as movie:
        for _ in range(10):
            movie.add(renderer.draw(world))
            movie.add(renderer.draw(world).array[:, :, :3])
            world.step(4)
    assert (tmp_path / "c.mp4").stat().st_size > 1000
    with pytest.raises(RuntimeError), obscura.Movie(tmp_path / "d.mp4", size=(16, 16), fps=10) as movie:
        movie.add(np.zeros((16, 16, 4), np.uint8))
        raise RuntimeError
    assert not [name for name in os.listdir(tmp_path) if "d.mp4" in name]
    with obscura.Movie(tmp_path / "e.mp4", size=(16, 16), fps=10) as movie:
        with pytest.raises(TypeError, match="float64"):
            movie.add(np.ones((16, 16, 3)))  # white, or nearly black?
        movie.add(np.ones((16, 16, 3), np.uint8))
    with pytest.raises(TypeError, match="size is"):
        scene.frames(size="640x360")
    assert scene.page(end=0.2, **SMALL).startswith("<!doctype html>")
    found = scene.sweep({"ball.elasticity": [0.5, 1]}, ["energy.total@0.5"])
    assert list(found["ball.elasticity"]) == [0.5, 1] and len(found["energy.total@0.5"]) == 2
    assert list(found["trouble"]) == ["", ""]


def test_a_film_of_a_force_says_that_it_cannot_be_verified(tmp_path):
    scene = obscura.Scene(ROOT / "scenes/room.toml")
    scene.add_force(lambda stage: 0 * stage.positions, "mine")
    scene.render(tmp_path / "a.mp4", end=0.1, **SMALL)
    run = program("verify", tmp_path / "a.mp4")
    assert run.returncode == 4 and "cannot be verified: the force 'mine' was computed by a program" in run.stderr


def test_notebooks_show_what_they_are_given():
    scene = obscura.Scene(ROOT / "scenes/room.toml")
    scene.duration = 0.2
    assert scene._repr_html_().startswith("<iframe srcdoc=")
    assert scene.frame(0.1, **SMALL)._repr_png_().startswith(b"\x89PNG")
    assert "<svg" in scene.picture(0.1)._repr_svg_()


LONG = {
    "read": "obscura.Scene(pipe)",
    "step": "obscura.Scene(room).world().step(10**12)",
    "step_to": "obscura.Scene(room).world().step_to(1e9)",
    "film": "obscura.Scene(room, sets=['duration=100000']).render('long.mp4', size=(160, 90))",
    "page": "obscura.Scene(room, sets=['duration=100000']).page(size=(160, 90))",
    "sweep": "obscura.Scene(room).sweep(['room.drag=0:1:1e-6'], 'energy.total@100000')",
    "sweep of long runs": "obscura.Scene(room, sets=['duration=1000000']).sweep(['room.drag=0,1'], 'energy.total@1000000')",
}


@pytest.mark.parametrize("what", LONG)
def test_other_threads_run_meanwhile_and_an_interrupt_ends_it(what, tmp_path):
    # No thread has to give up the lock on its own, for the time that it may keep it is out of reach: the other thread
    # begins where the work leaves the lock to it. It would never end if it kept it.
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "long.py").write_text(f"""
import obscura, os, signal, sys, threading
room, pipe = {str(ROOT / "scenes/room.toml")!r}, {str(tmp_path / "pipe")!r}
begin, ran = threading.Event(), []

def other():
    begin.wait()
    ran.append(1)
    if {what == "read"}:
        with open(pipe, "w") as file:
            file.write("[room]\\nsize = [4, 4]\\n")
    os.kill(os.getpid(), signal.SIGINT)

thread = threading.Thread(target=other)
thread.start()
sys.setswitchinterval(1e6)
try:
    begin.set()
    {LONG[what]}
    if {what != "read"}:
        print("not ended")
    thread.join()
    while True:
        pass
except KeyboardInterrupt:
    print("ended", ran)
""")
    run = subprocess.run([sys.executable, "long.py"], cwd=tmp_path, capture_output=True, text=True)
    assert run.stdout == "ended [1]\n" and run.returncode == 0, run.stderr
    assert sorted(os.listdir(tmp_path)) == ["long.py", "pipe"]  # no film is left


def test_python_ends_well_after_all_kinds_of_work(tmp_path):
    # what is of Python is let go before Python ends, or never
    work = f"""
import obscura
scene = obscura.Scene({str(ROOT / "scenes/room.toml")!r})
scene.add_force(lambda stage: 0 * stage.positions, "mine")
world = scene.world()
world.step()
renderer = scene.frames(size=(16, 16))
frame = renderer.draw(world)
movie = obscura.Movie("a.mp4", renderer)
movie.add(frame)
try:
    obscura.Scene({{"duration": -1}}).world()
except obscura.SceneError as error:
    kept = error
"""
    for text in ("import obscura", work):
        run = subprocess.run([sys.executable, "-c", text], cwd=tmp_path, capture_output=True, text=True)
        assert (run.returncode, run.stdout, run.stderr) == (0, "", ""), text


# --- the package


def test_the_six_lines_make_their_film(tmp_path):
    block = re.search(r"## A film in six lines\n.*?```python\n(.*?)```", (ROOT / "docs/python.md").read_text(), re.S).group(1)
    lines = [line for line in block.splitlines() if line]
    assert len(lines) <= 6
    short = block.replace("duration=3", "duration=0.2").replace("(640, 360)", "(160, 90)")
    assert short.count("0.2)") and short.count("(160, 90)") == 1
    subprocess.run([sys.executable, "-c", short], cwd=tmp_path, check=True)
    told = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-show_entries", "stream=width,height,nb_read_frames", "-of", "csv=p=0", "fall.mp4"],
                          cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    assert told.strip() == "160,90,12"


def test_stubs_name_what_there_is():
    stub = (ROOT / "src/python/obscura/__init__.pyi").read_text()
    named = set(re.findall(r"^(?:class|def) (\w+)", stub, re.M))
    assert named == set(obscura.__all__)
    for name in obscura.__all__:
        thing = getattr(obscura, name)
        assert inspect.getdoc(thing), name
        if not inspect.isclass(thing):
            continue
        body = re.search(rf"^class {name}\b.*?(?=^\S|\Z)", stub, re.M | re.S).group()
        told = set(re.findall(r"^    (?:def )?(\w+)(?:\(|:)", body, re.M))
        there = {member for member in dir(thing) if not member.startswith("_")} - set(dir(Exception))
        assert there <= told | inherited(stub, body), (name, there - told)


def test_editors_know_the_keys_of_scenes():
    stub = (Path(obscura.__file__).parent / "_keys.pyi").read_text()
    of = {name: body for name, body in re.findall(r"^class (\w+):\n((?:    .*\n)*)", stub, re.M)}
    assert "    radius: float | Sequence[float] | dict[str, Any]\n" in of["Ball"] and "    ball: Kind[Ball]\n" in of["Keys"]
    for key in obscura.schema()["properties"]:
        assert f"    {key}: " in of["Keys"], key
    jedi = pytest.importorskip("jedi")
    begun = "import obscura\nscene = obscura.Scene('a.toml')\n"
    for line, key in {"scene.dur": "duration", "scene.room.gra": "gravity", "scene.ball[0].rad": "radius",
                      "scene.film.fp": "fps"}.items():
        assert key in [each.name for each in jedi.Script(begun + line).complete()], line


def inherited(stub, body):
    found = re.match(r"class \w+\((\w+)", body)
    if not found or not (base := re.search(rf"^class {found.group(1)}\b.*?(?=^\S|\Z)", stub, re.M | re.S)):
        return set()
    return set(re.findall(r"^    (?:def )?(\w+)(?:\(|:)", base.group(), re.M))
