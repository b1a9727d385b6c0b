"""An experiment as a URScript program."""

from collections.abc import Sequence

from ..codegen.languages import URSCRIPT
from ..templates import renderer
from .experiments import Experiment
from .rehearsal import minutes_of, rounds_of
from .room import Room

#: rad/s and rad/s^2 of the move to the first waypoint, from wherever the robot stands.
_APPROACH = 0.2, 0.5
#: rad that waypoints are rounded to.
_DIGITS = 5


def script_of(experiment: Experiment, room: Room, names: Sequence[str]) -> str:
    """Print the program; names: what it shall tell apart, in words.

    Joints beyond the model's N stay where they are when it begins.
    """
    minutes = minutes_of(experiment)
    steps = [
        {
            "pose": [round(float(x), _DIGITS) for x in s.pose],
            "speed": round(float(s.speed), 4),
            "acceleration": round(float(s.acceleration), 4),
            "dwell": round(float(s.dwell), 3),
        }
        for s in experiment.steps
    ]
    template = renderer({"float_ur": URSCRIPT.number}).get_template("urscript/experiment.script.jinja")
    return template.render(
        name=experiment.name,
        text=experiment.text,
        names=list(names),
        minutes=round(minutes, 1),
        seconds=int(60 * minutes) + 60,
        rounds=rounds_of(experiment),
        load=float(experiment.load),
        fixed=list(range(room.dof, 6)),
        speed=round(experiment.speed, 2),
        approach=_APPROACH,
        first=steps[0],
        steps=steps[1:],
    )
