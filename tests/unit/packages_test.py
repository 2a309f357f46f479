#!/usr/bin/python3
"""What the packages need is what rosdep knows and what scripts/setup.bash installs."""
import glob
import os
import subprocess
import unittest
from xml.etree import ElementTree

import rosunit

ROOT = os.path.realpath(os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", ".."))

# Keys of ros/rosdistro as of 2026-08-22, rosdep/base.yaml and rosdep/python.yaml: Debian's package of
# each, which is Ubuntu's as well (but cli11, which is null for focal).
SYSTEM = {
    "cli11": "libcli11-dev", "eigen": "libeigen3-dev", "ffmpeg": "ffmpeg", "fmt": "libfmt-dev",
    "iproute2": "iproute2", "libnlopt-cxx-dev": "libnlopt-cxx-dev", "libnlopt-dev": "libnlopt-dev",
    "libpng-dev": "libpng-dev", "libssl-dev": "libssl-dev", "liburdfdom-tools": "liburdfdom-tools",
    "nlohmann-json-dev": "nlohmann-json3-dev",
    "pkg-config": "pkg-config", "python3-matplotlib": "python3-matplotlib",
    "python3-numpy": "python3-numpy", "python3-setuptools": "python3-setuptools",
    "yaml-cpp": "libyaml-cpp-dev",
}
# Packages of noetic/distribution.yaml.
ROS = {
    "actionlib", "actionlib_msgs", "catkin", "diagnostic_msgs", "diagnostic_updater",
    "geometry_msgs", "interactive_markers", "message_generation", "message_runtime", "nav_msgs",
    "pluginlib", "robot_state_publisher", "rosbag", "roscpp", "rosgraph_msgs", "roslib", "rospy",
    "rostest", "sensor_msgs", "std_msgs", "tf2_msgs", "tf2_ros", "topic_tools",
    "visualization_msgs",
}


def manifests():
    found = sorted(glob.glob(os.path.join(ROOT, "src", "*", "package.xml")))
    return {os.path.basename(os.path.dirname(path)): ElementTree.parse(path).getroot()
            for path in found}


class PackagesTest(unittest.TestCase):
    def test_rosdep_knows_all_that_they_depend_on(self):
        own = manifests()
        self.assertGreaterEqual(len(own), 5)
        for name, manifest in own.items():
            keys = {element.text for element in manifest if element.tag.endswith("depend")}
            self.assertLessEqual(keys, set(SYSTEM) | ROS | set(own), name)

    def test_setup_installs_what_the_manifests_name(self):
        shown = subprocess.run(["bash", "-c", "source scripts/setup.bash && echo ${packages[@]}"],
                               cwd=ROOT, stdout=subprocess.PIPE, encoding="utf-8", check=True)
        installed = shown.stdout.split()
        self.assertEqual(len(installed), len(set(installed)), "one is named twice")
        for name, manifest in manifests().items():
            for element in manifest:
                if element.text == "cli11" and os.path.exists("/opt/ros/noetic"):
                    continue  # the build gets it
                # catkin depends on python3-setuptools itself
                if element.text in SYSTEM and element.text != "python3-setuptools":
                    self.assertIn(SYSTEM[element.text], installed, name)


if __name__ == "__main__":
    rosunit.unitrun("threelink_tests", "packages", PackagesTest)
