// The least that a closed loop costs on Pinocchio: the operational-space law and a Runge-Kutta step, all in C++.
//
// In a tick: encoders (positions with their errors), forward kinematics, Jacobian, dJ/dt dq, the law as an acceleration,
// inverse dynamics, torque limits, a row of the log, and one Runge-Kutta step by the articulated-body algorithm.

#include <algorithm>
#include <exception>

#include "pinocchio/algorithm/aba.hpp"
#include "pinocchio/algorithm/frames.hpp"
#include "pinocchio/algorithm/jacobian.hpp"
#include "pinocchio/algorithm/kinematics.hpp"
#include "pinocchio/algorithm/rnea.hpp"
#include "pinocchio/parsers/urdf.hpp"

namespace {

using Eigen::Map;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Given = Eigen::Ref<const VectorXd>;  // as in the library's instantiations, which are then not made again
constexpr auto kWorldAxes = pinocchio::LOCAL_WORLD_ALIGNED;

class ClosedLoop {
 public:
  ClosedLoop(const char* urdf, const char* tip, double gravity) {
    pinocchio::urdf::buildModelFromXML(urdf, model_);
    model_.gravity.linear(Vector3d(0.0, 0.0, -gravity));
    data_ = pinocchio::Data(model_);
    tip_ = model_.getFrameId(tip);
    const int n = model_.nv;
    J_.setZero(6, n);
    for (VectorXd* vector : {&q_, &v_, &measured_, &rest_acceleration_, &asked_, &tau_, &q_i_, &v_i_, &a_, &one_, &two_})
      vector->setZero(n);
  }

  // law: k_p and k_v of the tip, k_p and k_v of the posture; other arrays as in bench/tip_loop.py.
  void run(int ticks, double h, const double* law, const double* held, const double* rest, const double* limits,
           const double* start, const double* desired, const double* errors, double* log) {
    const int n = model_.nv;
    const Map<const VectorXd> posture(rest, n), holds(held, n), limit(limits, n);
    q_ = Map<const VectorXd>(start, n);
    v_.setZero();
    for (int k = 0; k <= ticks; ++k) {
      const Map<const Matrix3d> reference(desired + 9 * k);  // columns: position, velocity, acceleration
      measured_ = q_ + Map<const VectorXd>(errors + n * k, n);
      evaluate(reference, law, posture, holds);
      tau_ = tau_.cwiseMin(limit).cwiseMax(-limit);
      Map<VectorXd>(log, n) = q_;
      Map<VectorXd>(log + n, n) = v_;
      Map<VectorXd>(log + 2 * n, n) = tau_;
      log += 3 * n;
      if (k < ticks) step(h);
    }
  }

 private:
  // Leaves M (a_0 + J^+ (F - dJ/dt dq - J a_0)) + bias in tau_; J^+ = J^-1 with three joints, where a_0 has no part.
  void evaluate(const Matrix3d& reference, const double* law, const Map<const VectorXd>& posture,
                const Map<const VectorXd>& holds) {
    rest_acceleration_.setZero();
    pinocchio::forwardKinematics(model_, data_, Given(measured_), Given(v_), Given(rest_acceleration_));
    pinocchio::computeJointJacobians(model_, data_);
    const Vector3d x = pinocchio::updateFramePlacement(model_, data_, tip_).translation();
    pinocchio::getFrameJacobian(model_, data_, tip_, kWorldAxes, J_);
    const Vector3d drift = pinocchio::getFrameClassicalAcceleration(model_, data_, tip_, kWorldAxes).linear();
    const auto J = J_.topRows<3>();
    const Vector3d speed = J * v_;
    Vector3d F = reference.col(2) + law[1] * (reference.col(1) - speed) + law[0] * (reference.col(0) - x) - drift;
    if (model_.nv == 3) {
      const Matrix3d square = J;
      asked_ = square.partialPivLu().solve(F);
    } else {
      rest_acceleration_ = -law[3] * v_ - law[2] * holds.cwiseProduct(measured_ - posture);
      F.noalias() -= J * rest_acceleration_;
      const Matrix3d square = J * J.transpose();
      asked_.noalias() = J.transpose() * square.llt().solve(F);
      asked_ += rest_acceleration_;
    }
    tau_ = pinocchio::rnea(model_, data_, Given(measured_), Given(v_), Given(asked_));
  }

  void step(double h) {
    const double ahead[4] = {0.5 * h, 0.5 * h, h, 0.0}, second[4] = {1.0, 2.0, 2.0, 1.0};
    q_i_ = q_;
    v_i_ = v_;
    one_.setZero();
    two_.setZero();
    for (int i = 0; i < 4; ++i) {
      a_ = pinocchio::aba(model_, data_, Given(q_i_), Given(v_i_), Given(tau_), pinocchio::Convention::LOCAL);
      two_ += second[i] * a_;
      if (i == 3) break;
      one_ += a_;
      q_i_ = q_ + ahead[i] * v_i_;
      v_i_ = v_ + ahead[i] * a_;
    }
    q_ += h * v_ + (h * h / 6.0) * one_;
    v_ += (h / 6.0) * two_;
  }

  pinocchio::Model model_;
  pinocchio::Data data_;
  pinocchio::FrameIndex tip_;
  pinocchio::Data::Matrix6x J_;
  VectorXd q_, v_, measured_, rest_acceleration_, asked_, tau_, q_i_, v_i_, a_, one_, two_;
};

}  // namespace

extern "C" {

// Return a closed loop around the arm of a URDF's text; null where that cannot be built.
void* make(const char* urdf, const char* tip, double gravity) {
  try {
    return new ClosedLoop(urdf, tip, gravity);
  } catch (const std::exception&) {
    return nullptr;
  }
}

void run(void* loop, int ticks, double h, const double* law, const double* held, const double* rest,
         const double* limits, const double* start, const double* desired, const double* errors, double* log) {
  static_cast<ClosedLoop*>(loop)->run(ticks, h, law, held, rest, limits, start, desired, errors, log);
}
}
