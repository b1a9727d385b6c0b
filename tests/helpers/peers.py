"""The same robot built for Pinocchio and for MuJoCo, from the robot's data alone."""

import mujoco
import numpy as np
import pinocchio as pin


def _frames(robot):
    """Placement of each joint's frame in the frame before it turns (rotation, translation)."""
    rotation, translation = np.eye(3), np.zeros(3)
    for joint in robot.joint:
        yield rotation, translation
        c, s = np.cos(joint.alpha), np.sin(joint.alpha)
        rotation = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
        translation = np.array([joint.a, 0.0, joint.d])


def _link(joint):
    """Mass, centre of mass and inertia about it in the turned frame."""
    c, s = np.cos(joint.alpha), np.sin(joint.alpha)
    rotation = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    xx, yy, zz, xy, xz, yz = joint.inertia
    tensor = rotation @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ rotation.T
    return joint.mass, rotation @ np.array(joint.centre_of_mass) + np.array([joint.a, 0, joint.d]), tensor


class PinocchioArm:
    """Mass matrix, momentum, beta, gravity, inverse dynamics by Pinocchio."""

    def __init__(self, robot, dof, angles=()):
        self.model = pin.Model()
        self.model.gravity.linear = np.array(robot.gravity)
        parent, placement = 0, pin.SE3.Identity()
        for i, ((rotation, translation), joint) in enumerate(zip(_frames(robot), robot.joint, strict=True)):
            step = pin.SE3(rotation, translation)
            if i < dof:
                parent = self.model.addJoint(parent, pin.JointModelRZ(), placement * step, f"joint{i + 1}")
                placement = pin.SE3.Identity()
                self.model.armature[i] = joint.reflected_inertia
            else:
                angle = angles[i - dof] if angles else 0.0
                placement = placement * step * pin.SE3(pin.utils.rotate("z", angle), np.zeros(3))
            self.model.appendBodyToJoint(parent, pin.Inertia(*_link(joint)), placement)
        self.data = self.model.createData()

    def mass_matrix(self, q):
        upper = np.triu(pin.crba(self.model, self.data, q))
        return upper + np.triu(upper, 1).T

    def gravity(self, q):
        return pin.computeGeneralizedGravity(self.model, self.data, q).copy()

    def momentum(self, q, qd):
        return self.mass_matrix(q) @ qd

    def beta(self, q, qd):
        coriolis = pin.computeCoriolisMatrix(self.model, self.data, q, qd).copy()
        return coriolis.T @ qd - self.gravity(q)

    def inverse_dynamics(self, q, qd, qdd):
        return pin.rnea(self.model, self.data, q, qd, qdd).copy()


class MujocoArm:
    """Mass matrix, gravity and inverse dynamics by MuJoCo."""

    def __init__(self, robot, dof, angles=()):
        spec = mujoco.MjSpec()
        spec.option.gravity = np.array(robot.gravity)
        spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
        body = spec.worldbody
        for i, ((rotation, translation), joint) in enumerate(zip(_frames(robot), robot.joint, strict=True)):
            turn = np.eye(3)
            if i >= dof:
                angle = angles[i - dof] if angles else 0.0
                turn = np.array(
                    [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
                )
            quaternion = np.zeros(4)
            mujoco.mju_mat2Quat(quaternion, (rotation @ turn).ravel())
            body = body.add_body(name=f"link{i + 1}", pos=translation, quat=quaternion)
            mass, centre, tensor = _link(joint)
            body.mass, body.ipos, body.explicitinertial = mass, centre, True
            body.fullinertia = tensor[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
            if i < dof:
                hinge = body.add_joint(name=f"joint{i + 1}", type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])
                hinge.armature = joint.reflected_inertia
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)

    def _at(self, q, qd):
        self.data.qpos[:], self.data.qvel[:] = q, qd

    def mass_matrix(self, q):
        self._at(q, np.zeros(len(q)))
        mujoco.mj_forward(self.model, self.data)
        full = np.zeros((self.model.nv, self.model.nv))
        mujoco.mj_fullM(self.model, self.data, full)
        return full

    def inverse_dynamics(self, q, qd, qdd):
        self._at(q, qd)
        self.data.qacc[:] = qdd
        mujoco.mj_inverse(self.model, self.data)
        return self.data.qfrc_inverse.copy()
