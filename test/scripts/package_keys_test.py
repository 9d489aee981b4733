#!/usr/bin/python3
"""Checks that rosdep has a key for every dependency in package.xml on Ubuntu 20.04 (focal) and Debian 12
(bookworm).

SYSTEM holds keys of rosdep/base.yaml and rosdep/python.yaml of github.com/ros/rosdistro with packages for
both, NOETIC names of packages in its noetic/distribution.yaml. Look a new key up there before it is added.
"""

import pathlib
import unittest
import xml.etree.ElementTree

PACKAGE = pathlib.Path(__file__).resolve().parents[2] / "package.xml"

SYSTEM = {"eigen", "libgmock-dev", "libgtest-dev", "libopencv-dev", "nlohmann-json-dev", "python3-matplotlib", "tbb",
          "yaml-cpp", "zlib"}
NOETIC = {"camera_calibration_parsers", "catkin", "cv_bridge", "depth_image_proc", "diagnostic_updater",
          "dynamic_reconfigure", "image_geometry", "image_proc", "image_transport", "message_filters",
          "message_generation", "message_runtime", "nodelet", "pluginlib", "rosbag", "roscpp", "roslib", "rostest",
          "sensor_msgs", "std_msgs", "stereo_image_proc", "stereo_msgs"}


class PackageKeys(unittest.TestCase):
    def test_every_key_is_known(self):
        root = xml.etree.ElementTree.parse(PACKAGE).getroot()
        keys = {element.text for element in root if element.tag.endswith("depend")}
        self.assertIn("roscpp", keys)
        self.assertEqual(keys - SYSTEM - NOETIC, set())


if __name__ == "__main__":
    unittest.main()
