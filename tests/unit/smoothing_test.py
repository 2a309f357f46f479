#!/usr/bin/python3
"""Over how many positions pictures and pages take means: a stroke, of any number of links."""
import unittest

import numpy as np
import rosunit

from threelink_report.episode import SMOOTHING, smoothing


def wave(hinges, period, states):
    """A wave that runs along the hinges, which turn at one speed to and fro, around a bent shape."""
    phase = 2 * np.pi * (np.arange(states)[:, None] / period + 0.17 * np.arange(hinges))
    return 0.1 * np.arange(hinges) - 0.2 + np.arcsin(np.cos(phase))


class SmoothingTest(unittest.TestCase):
    def test_is_the_odd_number_next_to_the_period(self):
        for hinges in range(3, 8):
            for period, wanted in ((32.17, 33), (41.72, 41), (55.04, 55), (116.4, 117)):
                self.assertEqual(smoothing(wave(hinges, period, 700)), wanted)
                self.assertEqual(smoothing(-wave(hinges, period, 700)[:, ::-1]), wanted)

    def test_is_fixed_for_three_links_and_without_a_stroke(self):
        self.assertEqual(smoothing(wave(2, 41.72, 700)), SMOOTHING)
        self.assertEqual(smoothing(wave(1, 41.72, 700)), SMOOTHING)
        self.assertEqual(smoothing(wave(4, 41.72, 30)), SMOOTHING)
        self.assertEqual(smoothing(wave(4, 41.72, 1)), SMOOTHING)
        self.assertEqual(smoothing(np.full((700, 4), 0.3)), SMOOTHING)
        line = np.sin(0.1 * np.arange(700))[:, None] * np.ones(5)
        self.assertEqual(smoothing(line), SMOOTHING)


if __name__ == "__main__":
    rosunit.unitrun("threelink_tests", "smoothing", SmoothingTest)
