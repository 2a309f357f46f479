#!/usr/bin/python3
"""The robot description: hinge angles put the links where the model puts them."""
import math
import os
import subprocess
import unittest
from xml.etree import ElementTree

import rosunit


def make_urdf(*arguments):
    program = subprocess.run(["catkin_find", "--first-only", "--libexec", "threelink_sim",
                              "make_urdf"], stdout=subprocess.PIPE, universal_newlines=True,
                             check=True).stdout.strip()
    return subprocess.run([program, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          universal_newlines=True)


def numbers(text):
    return [float(number) for number in text.split()]


def midpoints(robot, angles):
    """{link: (x, y, orientation)} of the boxes in base_link, by forward kinematics."""
    frames, joints = {"base_link": (0.0, 0.0, 0.0)}, robot.findall("joint")
    while joints:
        joint = next(j for j in joints if j.find("parent").get("link") in frames)
        joints.remove(joint)
        x, y, theta = frames[joint.find("parent").get("link")]
        origin = joint.find("origin")
        along = numbers(origin.get("xyz"))[0] if origin is not None else 0.0
        turn = 0.0
        if joint.get("type") == "revolute":
            turn = numbers(joint.find("axis").get("xyz"))[2] * angles[joint.get("name")]
        frames[joint.find("child").get("link")] = (x + along * math.cos(theta),
                                                   y + along * math.sin(theta), theta + turn)
    result = {}
    for link in robot.findall("link"):
        box = link.find("visual")
        if box is not None:
            x, y, theta = frames[link.get("name")]
            centre = numbers(box.find("origin").get("xyz"))[0]
            result[link.get("name")] = (x + centre * math.cos(theta),
                                        y + centre * math.sin(theta), theta)
    return result


class MakeUrdfTest(unittest.TestCase):
    def test_links_are_where_the_model_puts_them(self):
        for links in (2, 3, 4, 7):
            length = 0.02 / links
            robot = ElementTree.fromstring(
                make_urdf("--links", str(links), "--length-scale", "0.02").stdout)
            alpha = [0.3 * math.cos(3 * j) for j in range(links - 1)]
            # From the heading link outwards: theta_{j+1} = theta_j + alpha_j, midpoints half a link
            # from each hinge.
            theta, heading = [0.0] * links, links // 2
            for i in range(heading + 1, links):
                theta[i] = theta[i - 1] + alpha[i - 1]
            for i in reversed(range(heading)):
                theta[i] = theta[i + 1] - alpha[i]
            x, y = [0.0] * links, [0.0] * links
            order = [(i, i - 1, 1) for i in range(heading + 1, links)]
            order += [(i, i + 1, -1) for i in reversed(range(heading))]
            for i, inner, sign in order:
                x[i] = x[inner] + sign * length / 2 * (math.cos(theta[inner]) + math.cos(theta[i]))
                y[i] = y[inner] + sign * length / 2 * (math.sin(theta[inner]) + math.sin(theta[i]))

            found = midpoints(robot, {"hinge_%d" % (j + 1): a for j, a in enumerate(alpha)})
            self.assertEqual(len(found), links)
            for i in range(links):
                for value, expected in zip(found["link_%d" % (i + 1)], (x[i], y[i], theta[i])):
                    self.assertAlmostEqual(value, expected, 12)
            for box in robot.iter("box"):
                self.assertAlmostEqual(numbers(box.get("size"))[0], length, 12)

    def test_joint_limits(self):
        robot = ElementTree.fromstring(make_urdf("--time-scale", "4").stdout)
        limits = [joint.find("limit") for joint in robot.findall("joint")
                  if joint.get("type") == "revolute"]
        self.assertEqual(len(limits), 2)
        for limit in limits:
            self.assertAlmostEqual(float(limit.get("upper")), 2 * math.pi / 3, 12)
            self.assertAlmostEqual(float(limit.get("lower")), -2 * math.pi / 3, 12)
            self.assertEqual(float(limit.get("velocity")), 0.25)

    def test_check_urdf_accepts_it(self):
        path = os.path.join(os.environ.get("TMPDIR", "/tmp"), "make_urdf_test_%d" % os.getpid())
        try:
            with open(path, "w") as file:
                file.write(make_urdf().stdout)
            subprocess.run(["check_urdf", path], stdout=subprocess.DEVNULL, check=True)
        finally:
            os.remove(path)

    def test_bad_arguments(self):
        for arguments, text in (
                (["--links", "1"], '--links: "1" must be a whole number in [2, 32]'),
                (["--links", "x"], '--links: "x" must be a whole number in [2, 32]'),
                (["--links", "03"], '--links: "03" must be a whole number in [2, 32]'),
                (["--links=-3"], '--links: "-3" must be a whole number in [2, 32]'),
                (["--links", " 3"], '--links: " 3" must be a whole number in [2, 32]'),
                (["--links", ""], '--links: "" must be a whole number in [2, 32]'),
                (["--length-scale", " 3"], '--length-scale: " 3" must be a number'),
                (["--links", "9" * 30], "must be a whole number in [2, 32]"),
                (["--length-scale", "0"], '--length-scale: "0" must be a number in [1e-09, 1000000]'),
                (["--time-scale", "nan"], '--time-scale: "nan" must be a number in [0.001, 1000]'),
                (["--joint-limit", "1e999"], '--joint-limit: "1e999" must be a finite number'),
                (["--joint-limit", "4"], "joint_limit = 4: must be in [0.001, 3.14"),
                (["--size", "1"], "size")):
            result = make_urdf(*arguments)
            self.assertEqual(result.returncode, 2, arguments)
            self.assertIn(text, result.stderr)
            self.assertEqual(result.stdout, "")

    def test_output_that_nobody_takes(self):
        program = subprocess.check_output(["catkin_find", "--first-only", "--libexec", "threelink_sim",
                                           "make_urdf"], universal_newlines=True).strip()
        with open("/dev/full", "w") as full:
            result = subprocess.run([program], stdout=full, stderr=subprocess.PIPE,
                                    universal_newlines=True)
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stderr, "make_urdf: standard output cannot be written: "
                                        "No space left on device\n")


if __name__ == "__main__":
    rosunit.unitrun("threelink_tests", "make_urdf", MakeUrdfTest)
