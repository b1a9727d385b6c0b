"""Which names count as one: effects that no motion, or none of these, can tell apart."""

#: Two names share a family only where the catalogue itself says that they are one column in motion.
FAMILY = {
    "friction_asymmetry": "offset",
    "current_offset": "offset",
}
#: Answers that name no physics.
NO_NAME = {"unknown", "data_fault"}
#: Effects that sit on one joint; of the others the joints are not scored.
ON_A_JOINT = {
    "rotor_inertia", "drive_gain", "coulomb_friction", "viscous_friction", "friction_asymmetry",
    "current_offset", "stribeck", "nonlinear_viscous", "load_dependent_friction",
    "temperature_dependent_friction", "presliding_hysteresis", "joint_elasticity", "torque_ripple",
    "backlash", "position_dependent_friction", "cable_spring", "encoder_offset", "velocity_lag",
}  # fmt: skip


def family(name: str) -> str:
    """Return the family of an effect; most are alone in theirs."""
    return FAMILY.get(name, name)
