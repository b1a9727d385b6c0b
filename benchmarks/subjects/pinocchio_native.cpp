// Momentum and beta through Pinocchio's C++, for any number of joints up to 6.
//
// An arm is built once by `build`; the functions then take it by its number of joints, so that they have
// the signature of everything else that is timed.
#include <array>
#include <memory>

#include <pinocchio/multibody.hpp>

#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>
#include <pinocchio/algorithm/rnea.hpp>

namespace {

using Vector = Eigen::VectorXd;
using Input = Eigen::Map<const Vector>;
using Output = Eigen::Map<Vector>;

struct Arm {
    pinocchio::Model model;
    pinocchio::Model weightless;
    pinocchio::Data data;
    pinocchio::Data weightless_data;
    Vector zero;

    explicit Arm(const pinocchio::Model &of)
        : model(of), weightless(of), data(of), weightless_data(of), zero(Vector::Zero(of.nv))
    {
        weightless.gravity.setZero();
    }
};

std::array<std::unique_ptr<Arm>, 7> arms;

pinocchio::SE3 link_frame(const double *dh) // a, d, alpha, offset
{
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(dh[3], Eigen::Vector3d::UnitZ()).toRotationMatrix();
    const Eigen::Matrix3d twist = Eigen::AngleAxisd(dh[2], Eigen::Vector3d::UnitX()).toRotationMatrix();
    return pinocchio::SE3(turn * twist, turn * Eigen::Vector3d(dh[0], 0, dh[1]));
}

pinocchio::Inertia link_inertia(const double *body) // mass, centre of mass, xx, yy, zz, xy, xz, yz about it
{
    Eigen::Matrix3d tensor;
    tensor << body[4], body[7], body[8], body[7], body[5], body[9], body[8], body[9], body[6];
    return pinocchio::Inertia(body[0], Eigen::Map<const Eigen::Vector3d>(body + 1), tensor);
}

// p = M qd and C^T qd - g through the matrices that Pinocchio offers.
template <int DOF> void matrices(const double *q, const double *qd, double *momentum, double *beta)
{
    Arm &arm = *arms[DOF];
    const Input position(q, DOF), speed(qd, DOF);
    pinocchio::crba(arm.model, arm.data, position);
    pinocchio::computeCoriolisMatrix(arm.model, arm.data, position, speed);
    pinocchio::computeGeneralizedGravity(arm.model, arm.data, position);
    Output(momentum, DOF).noalias() = arm.data.M.selfadjointView<Eigen::Upper>() * speed;
    Output(beta, DOF).noalias() = arm.data.C.transpose() * speed - arm.data.g;
}

// Without Coriolis matrix: with no gravity and no speed, inverse dynamics of the acceleration qd is p,
// and half its derivative by q, transposed, times qd is C^T qd = dT/dq.
template <int DOF> void derivatives(const double *q, const double *qd, double *momentum, double *beta)
{
    Arm &arm = *arms[DOF];
    const Input position(q, DOF), speed(qd, DOF);
    pinocchio::computeRNEADerivatives(arm.weightless, arm.weightless_data, position, arm.zero, speed);
    pinocchio::computeGeneralizedGravity(arm.model, arm.data, position);
    Output(momentum, DOF) = arm.weightless_data.tau;
    Output(beta, DOF).noalias() = 0.5 * arm.weightless_data.dtau_dq.transpose() * speed - arm.data.g;
}

} // namespace

extern "C" {

// Joints beyond `moving` are rigid at zero angle and keep their mass.
void build(int moving, int joints, const double *dh, const double *bodies, const double *armature,
           const double *gravity)
{
    pinocchio::Model model;
    model.gravity.linear() = Eigen::Map<const Eigen::Vector3d>(gravity);
    pinocchio::JointIndex parent = 0;
    pinocchio::SE3 frame = pinocchio::SE3::Identity();
    for (int i = 0; i < joints; ++i) {
        if (i < moving) {
            parent = model.addJoint(parent, pinocchio::JointModelRZ(), frame, "joint_" + std::to_string(i + 1));
            frame.setIdentity();
        }
        frame = frame * link_frame(dh + 4 * i);
        model.appendBodyToJoint(parent, link_inertia(bodies + 10 * i), frame);
    }
    model.armature = Input(armature, moving);
    arms[static_cast<std::size_t>(moving)] = std::make_unique<Arm>(model);
}

void matrices_3(const double *q, const double *qd, double *p, double *b) { matrices<3>(q, qd, p, b); }
void matrices_6(const double *q, const double *qd, double *p, double *b) { matrices<6>(q, qd, p, b); }
void derivatives_3(const double *q, const double *qd, double *p, double *b) { derivatives<3>(q, qd, p, b); }
void derivatives_6(const double *q, const double *qd, double *p, double *b) { derivatives<6>(q, qd, p, b); }
}
