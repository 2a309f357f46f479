from setuptools import setup
from catkin_pkg.python_setup import generate_distutils_setup
setup(**generate_distutils_setup(
    packages=["threelink_report", "threelink_report.reproduction",
              "threelink_report.reproduction.figures"],
    package_dir={"": "python"},
    package_data={"threelink_report": ["assets/*"],
                  "threelink_report.reproduction": ["page.css", "published.json"]}))
