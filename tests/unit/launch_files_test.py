#!/usr/bin/python3
"""Every launch file loads, names only what exists, and explains all of its arguments."""
import math
import os
import sys
import tempfile
import unittest

import roslaunch
import roslaunch.arg_dump
import roslaunch.config
import roslib.packages
import rospkg
import rosunit

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), "../node"))
from random_policy import write_policy  # pylint: disable=wrong-import-position

FOLDER = os.path.join(rospkg.RosPack().get_path("threelink_tasks"), "launch")
VFS = os.path.realpath(os.path.join(rospkg.RosPack().get_path("threelink_tasks"),
                                    "config/policies/vfs.safetensors"))
FILES = sorted(os.path.join(FOLDER, name) for name in os.listdir(FOLDER)
               if name.endswith(".launch"))

# What arguments without a default are given here.
REQUIRED = {"bag": "/some/folder/some.bag", "file": "/some/points.csv",
            "hosts": "pc2,192.168.1.13", "out": "/some/run", "task": "path"}
# What every launch file of a task takes.
SHARED = {"rviz", "record", "seed", "episodes", "policy", "sampled", "realtime_factor", "bag_dir",
          "allow_other_swimmer", "world", "lan"}
LOOPBACK = [("ROS_IP", "127.0.0.1"), ("ROS_HOSTNAME", "127.0.0.1")]
# Installed only where somebody asks for it.
OPTIONAL_PACKAGES = {"rviz"}


def required(path):
    """What the arguments without a default are given here."""
    return {name: REQUIRED[name] for name, (_, default) in roslaunch.arg_dump.get_args([path]).items()
            if default is None}


def load(path, **arguments):
    arguments = ["%s:=%s" % item for item in arguments.items()]
    return roslaunch.config.load_config_default([(path, arguments)], None, assign_machines=False)


class LaunchFilesTest(unittest.TestCase):
    def test_there_are_some(self):
        names = {os.path.basename(path) for path in FILES}
        self.assertLessEqual({"click.launch", "live.launch", "playback.launch",
                              "pursuit.launch", "star.launch", "stroke.launch",
                              "task.launch", "train.launch", "train_cluster.launch",
                              "view.launch", "watch.launch", "waypoints.launch",
                              "workers.launch"}, names)

    def test_every_file_loads_and_every_node_exists(self):
        for path in FILES:
            with self.subTest(os.path.basename(path)):
                config = load(path, **required(path))
                self.assertGreater(len(config.nodes), 0)
                for node in config.nodes:
                    if node.package not in OPTIONAL_PACKAGES:
                        self.assertTrue(roslib.packages.find_node(node.package, node.type),
                                        "%s/%s" % (node.package, node.type))

    def test_every_argument_is_documented(self):
        for path in FILES:
            for name, (doc, _) in roslaunch.arg_dump.get_args([path]).items():
                with self.subTest(os.path.basename(path), argument=name):
                    self.assertGreater(len(doc or ""), 10)

    def test_every_file_says_what_it_starts(self):
        for path in FILES:
            with self.subTest(os.path.basename(path)), open(path) as file:
                before_launch = file.read().partition("<launch>")[0]
                self.assertIn("<!--", before_launch)
                self.assertIn("->", before_launch)

    def test_arguments_of_pursuit_reach_the_nodes(self):
        path = os.path.join(FOLDER, "pursuit.launch")
        arguments = roslaunch.arg_dump.get_args([path])
        self.assertEqual(SHARED | {"v_ratio"}, set(arguments))
        config = load(path, rviz="false", v_ratio="0.25", seed="7", episodes="3", policy=VFS,
                      realtime_factor="0", bag_dir="/b")
        value = {name: parameter.value for name, parameter in config.params.items()}
        self.assertEqual(value["/use_sim_time"], True)
        self.assertEqual(value["/threelink/task/v_ratio"], 0.25)
        self.assertEqual(value["/threelink/task/seed"], 7)
        self.assertEqual(value["/threelink/task/episodes"], 3)
        self.assertEqual(value["/threelink/task/record"], True)
        self.assertEqual(value["/threelink/task/task"], "pursuit")
        self.assertEqual(value["/threelink/agent/seed"], 7)
        # These are what the policy says of itself.
        self.assertIs(value["/threelink/agent/sampled"], False)
        self.assertEqual(value["/threelink/simulator/observation"], "direction")
        self.assertEqual(value["/threelink/task/policy"], VFS)
        self.assertEqual(value["/threelink/agent/policy"], VFS)
        self.assertEqual(value["/threelink/simulator/realtime_factor"], 0)
        self.assertEqual(value["/threelink/recorder/bag_dir"], "/b")
        self.assertNotIn("rviz", {node.type for node in config.nodes})
        without = load(path, rviz="false", record="false")
        self.assertNotIn("recorder_node", {node.type for node in without.nodes})
        self.assertIs(without.params["/threelink/agent/sampled"].value, True)
        self.assertEqual(without.params["/threelink/simulator/observation"].value, "target")
        with self.assertRaises(roslaunch.RLException):
            load(path, rviz="false", policy="/no/policy")

    def test_every_task_has_the_same_arguments_and_its_own_parameters(self):
        for file, task, own in (("star", "waypoints", set()), ("waypoints", "waypoints", {"file"}),
                                ("click", "clicked_point", set()), ("task", "path", {"task"})):
            with self.subTest(file):
                path = os.path.join(FOLDER, file + ".launch")
                self.assertEqual(set(roslaunch.arg_dump.get_args([path])), SHARED | own)
                given = {name: REQUIRED[name] for name in own}
                config = load(path, rviz="false", seed="7", sampled="true", **given)
                value = {name: parameter.value for name, parameter in config.params.items()}
                self.assertEqual(value["/threelink/task/task"], task)
                self.assertEqual(value["/threelink/agent/sampled"], True)
                self.assertEqual(value["/threelink/agent/seed"], 7)
                self.assertTrue(value["/threelink/agent/policy"].endswith(".safetensors"))
                self.assertEqual(value["/threelink/task/policy"], value["/threelink/agent/policy"])
                if "file" in own:
                    self.assertEqual(value["/threelink/task/points"], "/some/points.csv")

    def test_arguments_of_train_reach_the_nodes(self):
        path = os.path.join(FOLDER, "train.launch")
        config = load(path, config="c.yaml", out="runs/a", seed="0", episodes="80", workers="3",
                      threads="2", resume="true")
        value = {name: parameter.value for name, parameter in config.params.items()
                 if name.startswith("/threelink/learner/")}
        self.assertEqual(value, {
            "/threelink/learner/config": os.path.realpath("c.yaml"), "/threelink/learner/seed": 0,
            "/threelink/learner/out": os.path.realpath("runs/a"), "/threelink/learner/episodes": 80,
            "/threelink/learner/threads": 2, "/threelink/learner/resume": True,
            "/threelink/learner/replay": 1})
        self.assertEqual({node.name for node in config.nodes},
                         {"learner", "worker_1", "worker_2", "worker_3"})
        config = load(path, out="/b", workers="0")
        self.assertEqual({node.name for node in config.nodes}, {"learner"})
        self.assertNotIn("/threelink/learner/seed", config.params)  # it is the configuration's

    def test_every_file_is_bound_to_loopback_unless_it_is_opened(self):
        for path in FILES:
            name = os.path.basename(path)
            for lan in ("false", "true"):
                if name in ("cluster_workers.launch", "train_cluster.launch"):
                    arguments, closed = {}, False  # their workers are on other machines
                else:
                    arguments, closed = {"lan": lan}, lan == "false"
                if name == "train.launch":
                    arguments.update(live="true", watch="true")
                for node in load(path, **required(path), **arguments).nodes:
                    with self.subTest(name, lan=lan, node=node.name):
                        address = [item for item in node.env_args if item in LOOPBACK]
                        self.assertEqual(set(address), set(LOOPBACK if closed else []))

    def test_a_cluster_has_workers_on_each_machine(self):
        path = os.path.join(FOLDER, "train_cluster.launch")
        config = load(path, out="a", hosts="pc2,lab-3.local", workers="2", local_workers="1",
                      user="me", ssh_port="2222", env_loader="/there/env_loader", seed="4")
        self.assertEqual({node.name: node.machine_name for node in config.nodes},
                         {"learner": None, "worker_1": None, "on_pc2_1": "pc2", "on_pc2_2": "pc2",
                          "on_lab_3_local_1": "lab-3.local", "on_lab_3_local_2": "lab-3.local"})
        machine = config.machines["lab-3.local"]
        self.assertEqual((machine.address, machine.user, machine.ssh_port, machine.env_loader),
                         ("lab-3.local", "me", 2222, "/there/env_loader"))
        self.assertEqual(config.params["/threelink/learner/seed"].value, 4)
        for node in config.nodes:
            self.assertNotIn("ROS_IP", dict(node.env_args))
        config = load(path, out="a", hosts="pc2")
        self.assertEqual(os.access(config.machines["pc2"].env_loader, os.X_OK), True)

    def test_train_starts_a_loop_and_watchers_if_wanted(self):
        path = os.path.join(FOLDER, "train.launch")
        config = load(path, out="/b", workers="0", live="true")
        self.assertEqual({node.namespace + node.name for node in config.nodes},
                         {"/threelink/learner", "/threelink/live/agent",
                          "/threelink/live/simulator"})
        self.assertEqual(config.params["/threelink/live/agent/exact"].value, True)
        config = load(path, out="/b", workers="0", watch="true")
        self.assertEqual({node.name for node in config.nodes}, {
            "learner", "simulator", "robot_state_publisher", "agent", "task", "rviz"})
        for node in config.nodes:  # no watcher can end the training
            self.assertEqual(node.required, node.name == "learner")
        config = load(path, out="/b", workers="0", watch="true", rviz="false")
        self.assertNotIn("rviz", {node.name for node in config.nodes})
        config = load(os.path.join(FOLDER, "live.launch"), robot="true", name="robot")
        self.assertEqual({node.namespace + node.name for node in config.nodes},
                         {"/threelink/robot/agent"})
        self.assertEqual(config.params["/threelink/robot/agent/exact"].value, False)

    def test_a_stroke_is_a_file_of_the_caller_or_the_shipped_one(self):
        stroke = lambda name, **arguments: load(os.path.join(FOLDER, name), rviz="false", **arguments
                                                ).params["/threelink/stroke/file"].value
        self.assertTrue(os.path.isfile(stroke("stroke.launch")))
        self.assertEqual(stroke("stroke.launch", file="a.json"), os.path.realpath("a.json"))
        self.assertNotIn("/threelink/stroke/file",
                         load(os.path.join(FOLDER, "view.launch"), rviz="false").params)

    def test_a_task_may_bring_its_own_parameters(self):
        config = load(os.path.join(FOLDER, "task.launch"), rviz="false", task=os.path.join(
            os.path.dirname(os.path.realpath(__file__)), "../plugin/pendulum.yaml"))
        self.assertEqual(config.params["/threelink/task/task"].value, "pendulum")

    def test_the_swimmer_is_that_of_the_policy(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "five.safetensors")
            write_policy(path, links=5, dt=0.2, gamma=0.9, observation="target", joint_limit="1.25")
            params = load(os.path.join(FOLDER, "pursuit.launch"), rviz="false", policy=path).params
        value = lambda name: params["/threelink/simulator/" + name].value
        self.assertEqual([value(name) for name in ("links", "dt", "gamma", "joint_limit", "observation")],
                         [5, 0.2, 0.9, 1.25, "target"])
        robot = params["/threelink/robot_description"].value
        self.assertIn('<link name="link_5">', robot)
        self.assertIn('<limit lower="-1.25" upper="1.25"', robot)
        params = load(os.path.join(FOLDER, "pursuit.launch"), rviz="false", policy=VFS).params
        self.assertEqual([value(name) for name in ("links", "dt", "gamma", "joint_limit", "observation")],
                         [3, 0.1, 0.5, 2 * math.pi / 3, "direction"])

    def test_the_watched_swimmer_is_that_of_the_policy(self):
        policy = os.path.join(os.path.dirname(VFS), "vfs_n4.safetensors")
        for name, arguments in (("watch", {"policy": policy}),
                                ("train", {"out": "a", "watch": "true", "watch_policy": policy})):
            params = load(os.path.join(FOLDER, name + ".launch"), rviz="false", **arguments).params
            self.assertEqual(params["/threelink/watch/simulator/links"].value, 4)
            self.assertEqual(params["/threelink/watch/task/policy"].value, policy)
            self.assertIn('<link name="link_4">', params["/threelink/robot_description"].value)
        params = load(os.path.join(FOLDER, "watch.launch"), rviz="false").params
        self.assertEqual(params["/threelink/watch/simulator/links"].value, 3)
        self.assertEqual(params["/threelink/watch/task/policy"].value, VFS)

    def test_the_played_back_swimmer_is_that_of_the_bag(self):
        bags = os.path.join(os.path.dirname(os.path.realpath(__file__)), "../data/bags_1")
        (bag,) = [os.path.join(bags, name) for name in os.listdir(bags) if name.startswith("pursuit")]
        for path in (bag, "/some/folder/some.bag"):  # what is wrong with a bag is for the node to say
            params = load(os.path.join(FOLDER, "playback.launch"), rviz="false", bag=path).params
            robot = params["/threelink/robot_description"].value
            self.assertIn('<link name="link_3">', robot)
            self.assertNotIn('<link name="link_4">', robot)


if __name__ == "__main__":
    rosunit.unitrun("threelink_tests", "launch_files", LaunchFilesTest)
