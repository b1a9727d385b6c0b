"""Plant files: what they hold, and one line for what is wrong with them."""

import numpy as np
import pytest

from residuum.errors import InputError
from residuum.robots import load_robot
from residuum.virtual import Plant, Simulator, load_plant
from residuum.virtual.effects import LinkInertial, Payload, Stribeck
from residuum.virtual.plant import BaseFriction

GOOD = """
[payload]
mass = 1.5
centre_of_mass = [0.0, 0.01, 0.05]
intervals = [[2.0, 5.0]]

[[stribeck]]
joint = 2
torque = 2.0
speed = 0.05

[[obstacle]]
place = [0.5, 0.0, 0.3]
normal = [1.0, 0.0, 0.0]
stiffness = 3000.0

[outside]
tooth_defect = [{joint = 3, torque = 2.0, at = 0.5}]
"""


def written(tmp_path, text):
    file = tmp_path / "plant.toml"
    file.write_text(text)
    return file


def test_file_and_values_are_the_same(tmp_path):
    plant = load_plant(written(tmp_path, GOOD))
    assert plant.payload == Payload(mass=1.5, centre_of_mass=(0.0, 0.01, 0.05), intervals=((2.0, 5.0),))
    assert plant.stribeck == (Stribeck(joint=2, torque=2.0, speed=0.05),)
    assert set(plant.effects()) == {"payload", "stribeck", "outside.tooth_defect"}
    assert Plant().effects() == {}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[paylod]\nmass = 1.0\n", ["paylod", "not a known key"]),
        ("[payload]\nmas = 1.0\n", ["payload", "mass", "missing"]),
        ("[payload]\nmass = 1.0\nspeed = 2.0\n", ["line 3", "speed", "not a known key"]),
        ("[payload]\nmass = -1.0\n", ["line 2", "mass"]),
        ("[payload]\nmass = 1.0\ninertia = [0.1, 0.1, 0.3, 0, 0, 0]\n", ["line 3", "triangle"]),
        ("[[stribeck]]\njoint = 7\ntorque = 1.0\nspeed = 0.1\n", ["line 2", "stribeck", "joint"]),
        ("[[stribeck]]\njoint = 1\ntorque = nan\nspeed = 0.1\n", ["line 3", "torque"]),
        ("[outside]\nwobble = 1\n", ["line 2", "wobble", "not a known key"]),
        ("[friction]\nkind = 'curve'\n", ["friction", "speed"]),
        ("[payload\n", ["TOML"]),
    ],
)
def test_bad_files_get_one_line(tmp_path, text, words):
    with pytest.raises(InputError) as caught:
        load_plant(written(tmp_path, text))
    message = str(caught.value)
    assert "\n" not in message and "plant.toml" in message
    assert all(word in message for word in words), message


def test_two_gears_in_one_joint_are_refused(tmp_path):
    text = "[[backlash]]\njoint = 2\ngap = 0.001\n[[joint_elasticity]]\njoint = 2\nstiffness = 1e4\n"
    with pytest.raises(InputError, match="one entry of joint_elasticity or backlash"):
        load_plant(written(tmp_path, text))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"mass": -3.0}, "mass becomes -0.154 kg"),
        ({"inertia": (-0.1, 0, 0, 0, 0, 0)}, "moment of inertia is negative"),
    ],
)
def test_impossible_links_are_refused(change, words):
    with pytest.raises(InputError, match=words):
        Simulator(load_robot("ur5e")[0], Plant(link_inertial=(LinkInertial(link=3, **change),)))


def test_joints_that_the_robot_lacks_are_refused():
    robot, _ = load_robot("ur5e")
    short = robot.model_copy(update={"joint": robot.joint[:3]})
    with pytest.raises(InputError, match="stribeck: joint or link 5"):
        Simulator(short, Plant(stribeck=(Stribeck(joint=5, torque=1.0, speed=0.1),)))
    curve = BaseFriction(kind="curve", speed=(-1.0, 1.0), torque=((-2.0, 2.0),), stiction=((-1.0, 1.0),))
    with pytest.raises(InputError, match="1 rows of torque for 3 joints"):
        Simulator(short, Plant(friction=curve), np.zeros(3))
