"""What Gylling 2019 (KTH, TRITA-ITM-EX 2019:277) reports; keys are (joint 1 to 3, pace)."""

#: Joint speeds of the experiments, rad/s (tables 1-3).
SPEEDS = {
    (1, "slow"): 0.25, (2, "slow"): 0.20, (3, "slow"): 0.25,
    (1, "fast"): 0.50, (2, "fast"): 0.40, (3, "fast"): 0.50,
}  # fmt: skip
PACES = ("slow", "fast")
REPEATS = 5
#: Thresholds of the external torque, Nm, by joint.
THRESHOLDS = (1.0, 1.0, 0.70)
#: Strategy 3 drives the joint that detects at this speed (rad/s) and acceleration (rad/s^2).
RETRACT_SPEED, RETRACT_ACCELERATION = 0.5, 3.0

#: Impulse in Ns for strategies 1, 2, 3 (tables 5 and 7).
IMPULSE = {
    (1, "slow"): (3.4551, 0.7097, 1.1430),
    (2, "slow"): (14.6420, 2.1367, 2.5849),
    (3, "slow"): (3.4391, 0.7612, 0.9075),
    (1, "fast"): (4.7879, 1.3953, 1.8851),
    (2, "fast"): (30.0440, 8.8864, 10.3970),
    (3, "fast"): (10.9070, 10.1130, 10.0580),
}
#: Stop time in ms for strategies 1, 2, 3 (tables 5 and 7).
STOP_TIME = {
    (1, "slow"): (168, 440, 800), (2, "slow"): (200, 440, 688), (3, "slow"): (100, 380, 570),
    (1, "fast"): (264, 648, 616), (2, "fast"): (224, 576, 600), (3, "fast"): (184, 432, 576),
}  # fmt: skip
#: Detection delay in ms (tables 5 and 7), and its averages.
DELAY = {
    (1, "slow"): 136, (2, "slow"): 120, (3, "slow"): 180, (1, "fast"): 40, (2, "fast"): 88, (3, "fast"): 32,
}  # fmt: skip
MEAN_DELAY = {"slow": 145, "fast": 53}
#: Delay of UR's own protection in ms, least and most restricted presets (tables 9 and 10).
UR_DELAY = {
    (1, "slow"): (232, 96), (2, "slow"): (296, 236), (3, "slow"): (480, 352),
    (1, "fast"): (160, 88), (2, "fast"): (216, 200), (3, "fast"): (312, 232),
}  # fmt: skip
UR_MEAN_DELAY = {"slow": (336, 228), "fast": (229, 173)}


def ur_delay(joint: int, pace: str, preset: int) -> float:
    """Return the delay in s of UR's protection, preset 0 least or 1 most restricted.

    Joints 4 to 6 were not tried in the thesis: they get the average of 1 to 3.
    """
    measured = UR_DELAY.get((joint, pace))
    return 1e-3 * (measured or UR_MEAN_DELAY[pace])[preset]
