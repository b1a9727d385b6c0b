"""What a case may hide, by name; a draw gives joint, direction and shape, and leaves the size open."""

from collections.abc import Callable

from . import bodies, frictions, gears
from .scene import Drawn, Scene

Draw = Callable[[Scene], Drawn]
CATALOGUE: dict[str, Draw] = {
    "payload": bodies.payload,
    "link_inertial": bodies.link_inertial,
    "base_tilt": bodies.base_tilt,
    "rotor_inertia": bodies.rotor_inertia,
    "drive_gain": bodies.drive_gain,
    "coulomb_friction": frictions.coulomb_friction,
    "viscous_friction": frictions.viscous_friction,
    "friction_asymmetry": frictions.friction_asymmetry,
    "current_offset": bodies.current_offset,
    "stribeck": frictions.stribeck,
    "nonlinear_viscous": frictions.nonlinear_viscous,
    "load_dependent_friction": frictions.load_dependent_friction,
    "temperature_dependent_friction": frictions.temperature_dependent_friction,
    "presliding_hysteresis": frictions.presliding_hysteresis,
    "joint_elasticity": gears.joint_elasticity,
    "torque_ripple": gears.torque_ripple,
    "backlash": gears.backlash,
    "position_dependent_friction": frictions.position_dependent_friction,
    "cable_spring": bodies.cable_spring,
    "encoder_offset": bodies.encoder_offset,
    "time_delay": bodies.time_delay,
    "velocity_lag": frictions.velocity_lag,
    "external_contact": bodies.external_contact,
}
OUTSIDE: dict[str, Draw] = {
    "outside.tooth_defect": gears.tooth_defect,
    "outside.loose_cable": gears.loose_cable,
    "outside.amplifier": gears.amplifier,
    "outside.loaded_cogging": gears.loaded_cogging,
    "outside.slipping_brake": gears.slipping_brake,
}
#: Without a reference these are fitted anyway (friction) or cannot be seen (gain), so they are no finding.
NEEDS_REFERENCE = {"drive_gain", "coulomb_friction", "viscous_friction"}
SIZES = (0.2, 0.35, 0.5, 1.0, 2.0)  # effect rms over residual rms
OUTSIDE_SIZES = (0.35, 0.5, 1.0, 2.0)


def names(reference: bool) -> list[str]:
    """Return the effects of the catalogue that a case can hide."""
    return [name for name in CATALOGUE if reference or name not in NEEDS_REFERENCE]
