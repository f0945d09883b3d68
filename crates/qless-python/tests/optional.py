"""Packages that adapters need: a test is skipped, with a message, only if its package cannot be imported."""

import importlib

import pytest

#: The name in `pip install` of each package.
WHEELS = {"mujoco": "mujoco", "pinocchio": "pin", "openseespy.opensees": "openseespy", "highspy": "highspy"}


def package(name):
    """The package. OpenSees raises other errors than ImportError if its libraries do not load."""
    try:
        return importlib.import_module(name)
    except (ImportError, OSError, RuntimeError) as error:
        pytest.skip(f"{name} cannot be imported ({error}): pip install {WHEELS[name]}", allow_module_level=True)
