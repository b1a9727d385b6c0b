"""What has no name still has a place: a flexible curve knows it, or physics that was refused at its size."""

from dataclasses import replace

from residuum.mismatch.evidence import Evidence, renewed
from residuum.mismatch.judging import judge
from residuum.mismatch.naming import reweighed
from residuum.mismatch.unknown import unknowns


def told(evidence: Evidence):
    """What is judged and what stays unknown."""
    judged = judge(evidence)
    return judged, unknowns(evidence, reweighed(evidence, judged.model), judged)


def test_nothing_is_unknown_of_a_healthy_arm(healthy) -> None:
    judged, strange = told(healthy)
    assert judged.accepted == () and strange == []


def test_a_gear_softer_than_any_gear_is_unknown_where_it_is(healthy) -> None:
    space, (rows,) = healthy.setup.space, healthy.runs
    place, joint = space.common_index("elasticity2"), 1
    torque = rows.torque.copy()
    for j in range(space.dof):
        torque[:, j] += rows.columns[j][:, space.indices[j].tolist().index(place)] / 300.0  # Nm/rad
    judged, strange = told(renewed(healthy, [replace(rows, torque=torque)]))
    assert any("no gear's" in why for s, why in judged.refused if s.candidate.effect == "joint_elasticity")
    assert joint in [u.joint for u in strange]
    assert "joint_elasticity" not in [a.score.candidate.effect for a in judged.accepted]
