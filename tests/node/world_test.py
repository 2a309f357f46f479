#!/usr/bin/python3
"""An episode in a world, as users launch it: recorded, proven, and the same to the bit in one process."""
import glob
import os
import re
import shutil
import subprocess
import tempfile
import unittest

import rosbag
import roslib.packages
import rospkg
import rostest
import yaml

HERE = os.path.dirname(os.path.realpath(__file__))
LAUNCH = os.path.join(HERE, "../../scripts/launch.py")
POLICY = os.path.realpath(os.path.join(rospkg.RosPack().get_path("threelink_tasks"),
                                       "config/policies/homing.safetensors"))
STEPS = 1500
# A flow of the workspace and one of a plug-in, noise, and walls so near that the swimmer touches them.
WORLD = """flow:
  - {kind: taylor_green, u0: 0.0129, k: 1.5707963267948966, phase: [0.5, 0.0]}
  - {kind: stirred, rate: 0.002}
obstacles:
  - {kind: half_plane, point: [2.1, 0.0], normal: [-1.0, 0.0]}
  - {kind: half_plane, point: [0.9, 0.0], normal: [1.0, 0.0]}
  - {kind: half_plane, point: [0.0, 0.55], normal: [0.0, -1.0]}
  - {kind: half_plane, point: [0.0, -0.55], normal: [0.0, 1.0]}
thermal_noise: 1.0e-6
"""
# The flow carries the swimmer out of it within a few steps.
GRID = "x y u v\n" + "".join("%g %g 0.3 0\n" % (x, y) for x in (-3, -1, 1, 3) for y in (-3, -1, 1, 3))


def program(package, name):
    return roslib.packages.find_node(package, name)[0]


def run(*command, **kwargs):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True,
                          timeout=100, check=False, **kwargs)


def play(folder, world, steps):
    """What the launch of an episode says, its exit status, and the messages of its bag by topic."""
    done = run("/usr/bin/python3", LAUNCH, os.path.join(HERE, "short_episode.launch"), "rviz:=false",
               "bag_dir:=" + folder, "max_steps:=%d" % steps, "world:=" + world)
    bags = glob.glob(os.path.join(folder, "*.bag"))
    return done, bags[0] if bags else None


def messages(path):
    found = {}
    with rosbag.Bag(path) as bag:
        for topic, message, _ in bag.read_messages():
            found.setdefault(topic.rpartition("/")[2], []).append(message)
    return found


class WorldTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        cls.world = os.path.join(cls.folder, "world.yaml")
        with open(cls.world, "w") as file:
            file.write(WORLD)
        cls.done, cls.bag = play(os.path.join(cls.folder, "bags"), cls.world, STEPS)
        cls.messages = messages(cls.bag) if cls.bag else {}

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def setUp(self):
        self.assertEqual(self.done.returncode, 0, self.done.stdout)

    def changed(self, change):
        """What verify_bag says of the bag as change(topic, message) leaves its messages."""
        path = os.path.join(self.folder, "changed.bag")
        with rosbag.Bag(self.bag) as whole, rosbag.Bag(path, "w") as copy:
            for topic, message, stamp in whole.read_messages():
                change(topic.rpartition("/")[2], message)
                copy.write(topic, message, stamp)
        return run(program("threelink_tasks", "verify_bag"), path)

    def test_the_bag_holds_the_world_and_its_state_at_each_step(self):
        states = self.messages["world_state"]
        self.assertEqual([message.step for message in states], list(range(STEPS + 1)))
        self.assertEqual([message.header.stamp for message in states],
                         [message.header.stamp for message in self.messages["state"]])
        self.assertGreater(max(message.contacts for message in states), 0)
        self.assertEqual(states[0].dissipation, 0)
        self.assertGreater(min(message.dissipation for message in states[1:]), 0)
        for message in states:
            if message.contacts == 0:
                self.assertEqual((*message.contact_force, message.contact_torque), (0, 0, 0))
        config = yaml.safe_load(self.messages["episode"][0].config)
        world = yaml.safe_load(config["simulator"]["world"])
        self.assertEqual(world["flow"][0]["u0"], 0.0129)
        self.assertEqual(world["flow"][1], {"kind": "stirred", "rate": 0.002, "period": 200.0})
        self.assertEqual(world["link_radius"], 0.01)  # defaults, too

    def test_the_bag_proves_itself(self):
        proof = run(program("threelink_tasks", "verify_bag"), self.bag)
        self.assertEqual(proof.returncode, 0, proof.stdout)
        self.assertIn("OK: episode", proof.stdout)

    def test_another_flow_is_found(self):
        def change(topic, message):
            if topic == "episode":
                self.assertIn("u0: 0.0129", message.config)
                message.config = message.config.replace("u0: 0.0129", "u0: 0.012900001")
        proof = self.changed(change)
        self.assertEqual(proof.returncode, 1, proof.stdout)
        self.assertIn("world_state.flow", proof.stdout)

    def test_another_noise_is_found(self):
        def change(topic, message):
            if topic == "episode":
                message.config, count = re.subn(r"thermal_noise: [0-9.e-]+", "thermal_noise: 1.0001e-06", message.config)
                self.assertEqual(count, 1, message.config)
        proof = self.changed(change)
        self.assertEqual(proof.returncode, 1, proof.stdout)
        self.assertIn("step 1", proof.stdout)

    def test_a_changed_world_state_is_found_and_named(self):
        pressed = next(m.step for m in self.messages["world_state"] if m.contacts > 0)
        for field, value in (("dissipation", 1e-3), ("contacts", 31), ("flow", (0.0, 0.0)),
                             ("contact_torque", 1e-9)):
            def change(topic, message):
                if topic == "world_state" and message.step == pressed:
                    setattr(message, field, value)
            with self.subTest(field):
                proof = self.changed(change)
                self.assertEqual(proof.returncode, 1, proof.stdout)
                self.assertIn(field, proof.stdout)

    def test_equals_the_episode_in_one_process_with_each_fused_instruction_set_to_the_bit(self):
        with open("/proc/cpuinfo") as file:
            flags = file.read()
        # Without fused multiply-adds, `baseline`, the last bits may differ (docs/model.md).
        for isa, flag in (("avx2", "avx2"), ("avx512", "avx512dq")):
            if flag not in flags:
                continue
            with self.subTest(isa):
                done = run(program("threelink_tests", "play_episode"), POLICY, "5", "1", "pursuit",
                           "{v_ratio: 0.5, max_steps: %d}" % STEPS, "sampled", self.world,
                           env=dict(os.environ, THREELINK_ISA=isa))
                self.assertEqual(done.returncode, 0, done.stdout)
                played = [[float.fromhex(word) for word in line.split()] for line in done.stdout.splitlines()]
                self.assertEqual(len(played), STEPS + 1)
                for line, state in zip(played, self.messages["state"]):
                    self.assertEqual(line[:5], [*state.centroid, state.theta[1], *state.alpha])

    def test_an_episode_ends_where_the_grid_of_the_flow_ends(self):
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "flow.txt"), "w") as file:
                file.write(GRID)
            world = os.path.join(folder, "grid.yaml")
            with open(world, "w") as file:
                file.write("flow: [{kind: grid, file: flow.txt}]\n")
            done, bag = play(folder, world, STEPS)
            self.assertNotEqual(done.returncode, 0, done.stdout)
            self.assertIn("the swimmer has left the grid of the flow", done.stdout)
            proof = run(program("threelink_tasks", "verify_bag"), bag)
            self.assertEqual(proof.returncode, 0, proof.stdout)
            # The proof needs the same file.
            with open(os.path.join(folder, "flow.txt"), "a") as file:
                file.write("# another one\n")
            proof = run(program("threelink_tasks", "verify_bag"), bag)
            self.assertEqual(proof.returncode, 1, proof.stdout)
            self.assertIn("it is another file", proof.stdout)

    def test_bad_worlds_are_refused_before_the_first_step(self):
        for world, words in (("flow: [{kind: taylor_gren}]", "taylor_green"),
                             ("flow: [{kind: stirred, rate: 2.0}]", "must be in [0, 1]"),
                             ("flow: [{kind: stirred, rat: 0.5}]", "rate"),
                             ("thermal_noise: -1", "must be in [0, 0.1]"),
                             ("obstacles: [{kind: disc, center: [1.5, 0], radius: 0.1}]", "within an obstacle"),
                             ("/nowhere/world.yaml", "/nowhere/world.yaml")):
            with self.subTest(world):
                done, bag = play(os.path.join(self.folder, "none"), self.file_of(world), 10)
                # What only the start shows, the simulator refuses to the task, which fails.
                self.assertEqual(done.returncode, 1 if "obstacle" in words else 2, done.stdout)
                self.assertIn(words, done.stdout)
                self.assertIsNone(bag)

    def file_of(self, world):
        if world.startswith("/"):
            return world
        path = os.path.join(self.folder, "bad.yaml")
        with open(path, "w") as file:
            file.write(world + "\n")
        return path


if __name__ == "__main__":
    rostest.rosrun("threelink_tests", "world", "__main__")
