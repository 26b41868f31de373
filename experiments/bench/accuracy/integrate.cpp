// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/accuracy/integrate.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "core/simulation.hpp"

namespace shearcell::accuracy {
namespace {

template <class Real>
using Columns = Eigen::Matrix<Real, 3, Eigen::Dynamic>;

// Contact forces over a list of near pairs, made again before any pair beyond it could touch.
template <class State, class Force>
class Contacts {
 public:
  explicit Contacts(const Box& box) : box_(box) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      size_[axis] = static_cast<State>(box.size[axis]);
      per_size_[axis] = 1 / size_[axis];
    }
  }

  /// Accelerations without drag.
  void sum(const Columns<State>& x, Columns<Force>& a) {
    if (!valid(x)) list_pairs(x);
    a.setZero(3, x.cols());
    a.row(1).array() -= static_cast<Force>(box_.gravity);
    const auto stiffness = static_cast<Force>(box_.stiffness);
    for (const auto& [i, j] : pairs_) {
      Eigen::Matrix<State, 3, 1> difference = x.col(i) - x.col(j);
      for (Eigen::Index axis = box_.walls ? 2 : 0; axis < 3; ++axis) {
        difference[axis] -= size_[axis] * std::nearbyint(difference[axis] * per_size_[axis]);
      }
      const Eigen::Matrix<Force, 3, 1> dr = difference.template cast<Force>();
      const Force square = dr.squaredNorm();
      if (!(square < 1)) continue;
      const Force factor = stiffness * (1 / std::sqrt(square) - 1);
      a.col(i) += factor * dr;
      a.col(j) -= factor * dr;
    }
    if (!box_.walls) return;
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      for (Eigen::Index axis = 0; axis < 2; ++axis) {
        const auto half = static_cast<State>(0.5);
        const State low = std::max(half - x(axis, i), State{0});
        const State high = std::max(half - (size_[axis] - x(axis, i)), State{0});
        a(axis, i) += stiffness * static_cast<Force>(low - high);
      }
    }
  }

 private:
  static constexpr double kMargin = 0.1;

  bool valid(const Columns<State>& x) const {
    if (listed_at_.cols() != x.cols()) return false;
    const auto limit = static_cast<State>(kMargin * kMargin);
    return (x - listed_at_).colwise().squaredNorm().maxCoeff() < limit;
  }

  void list_pairs(const Columns<State>& x) {
    pairs_.clear();
    listed_at_ = x;
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      for (Eigen::Index j = i + 1; j < x.cols(); ++j) {
        const Eigen::Vector3d dr = nearest(box_, (x.col(i) - x.col(j)).template cast<double>());
        if (dr.norm() < 1 + 2 * kMargin) pairs_.emplace_back(i, j);
      }
    }
  }

  Box box_;
  Eigen::Matrix<State, 3, 1> size_, per_size_;
  Columns<State> listed_at_;
  std::vector<std::pair<Eigen::Index, Eigen::Index>> pairs_;
};

template <class State, class Force>
class Splitting {
 public:
  Splitting(const Box& box, const Method& method, const Motion& start, double dt)
      : method_(method),
        drag_(box.drag_rate),
        dt_(dt),
        contacts_(box),
        x_(start.position.cast<State>()),
        v_(start.velocity.cast<State>()) {}

  void step() {
    drift(method_.first_drift);
    for (const Substep& substep : method_.substeps) {
      contacts_.sum(x_, a_);
      kick(substep.kick * dt_);
      drift(substep.drift);
    }
  }

  Motion motion() const { return {x_.template cast<double>(), v_.template cast<double>()}; }

 private:
  void drift(double part) {
    if (part != 0) x_ += static_cast<State>(part * dt_) * v_;
  }

  void kick(double h) {
    double keep = 1, gain = h;
    if (method_.exact_drag) {
      keep = std::exp(-drag_ * h);
      if (drag_ != 0) gain = -std::expm1(-drag_ * h) / drag_;
    } else {
      keep = (1 - drag_ * h / 2) / (1 + drag_ * h / 2);
      gain = h / (1 + drag_ * h / 2);
    }
    v_ = static_cast<State>(keep) * v_ + static_cast<State>(gain) * a_.template cast<State>();
  }

  const Method& method_;
  double drag_, dt_;
  Contacts<State, Force> contacts_;
  Columns<State> x_, v_;
  Columns<Force> a_;
};

class RungeKutta {
 public:
  RungeKutta(const Box& box, const Motion& start, double dt)
      : drag_(box.drag_rate), dt_(dt), contacts_(box), now_(start) {}

  void step() {
    const Motion k1 = rate(now_), k2 = rate(moved(k1, dt_ / 2)), k3 = rate(moved(k2, dt_ / 2)),
                 k4 = rate(moved(k3, dt_));
    const auto blend = [&](auto part) -> Eigen::Matrix3Xd {
      return dt_ / 6 * (part(k1) + 2 * part(k2) + 2 * part(k3) + part(k4));
    };
    now_.position += blend([](const Motion& k) -> const Eigen::Matrix3Xd& { return k.position; });
    now_.velocity += blend([](const Motion& k) -> const Eigen::Matrix3Xd& { return k.velocity; });
  }

  const Motion& motion() const { return now_; }

 private:
  Motion moved(const Motion& rate, double h) const {
    return {now_.position + h * rate.position, now_.velocity + h * rate.velocity};
  }

  Motion rate(const Motion& at) {
    Eigen::Matrix3Xd a;
    contacts_.sum(at.position, a);
    return {at.velocity, a - drag_ * at.velocity};
  }

  double drag_, dt_;
  Contacts<double, double> contacts_;
  Motion now_;
};

// Between walls that rest: the moving one is too heavy to stir.
class Engine {
 public:
  Engine(const Box& box, const Motion& start, double dt)
      : simulation_(cell(box), scene(box, dt), state(start)) {}
  void step() { simulation_.advance(Drive{}, 1); }
  Motion motion() const {
    const State now = simulation_.state();
    return {now.position, now.velocity};
  }

 private:
  static Cell cell(const Box& box) {
    if (!box.walls) throw std::invalid_argument("the engine is periodic in z alone");
    Cell cell;
    cell.width = box.size.x();
    cell.top = box.size.y();
    cell.depth = box.size.z();
    return cell;
  }
  static Scene scene(const Box& box, double dt) {
    Scene scene;
    scene.stiffness = box.stiffness;
    scene.drag_rate = box.drag_rate;
    scene.gravity = box.gravity;
    scene.wall_mass = 1e30;
    scene.time_step = dt;
    return scene;
  }
  static State state(const Motion& start) {
    State state;
    state.position = start.position;
    state.velocity = start.velocity;
    return state;
  }
  Simulation simulation_;
};

template <class Integrator>
void run(Integrator&& integrator, std::uint64_t steps, std::uint64_t every, const Visit& visit) {
  for (std::uint64_t n = 1; n <= steps; ++n) {
    integrator.step();
    if (n % every == 0) visit(n, integrator.motion());
  }
}

std::vector<Method> make_methods() {
  constexpr double xi = 0.1786178958448091, lambda = -0.2123418310626054,
                   chi = -0.6626458266981849e-1;
  const std::vector<Substep> leapfrog = {{1, 1}};
  const std::vector<Substep> pefrl = {
      {0.5 - lambda, chi}, {lambda, 1 - 2 * (chi + xi)}, {lambda, chi}, {0.5 - lambda, xi}};
  Method product{.name = "engine", .kind = Method::Kind::engine};
  product.staggered = true;
  Method plain{.name = "leapfrog", .substeps = leapfrog};
  plain.exact_drag = false;
  plain.staggered = true;
  Method exponential = plain;
  exponential.name = "leapfrog exact drag";
  exponential.exact_drag = true;
  Method fourth{.name = "PEFRL", .substeps = pefrl, .first_drift = xi};
  fourth.evaluations = fourth.order = 4;
  Method classical{.name = "Runge-Kutta", .kind = Method::Kind::runge_kutta};
  classical.evaluations = classical.order = 4;
  Method single = plain, mixed = plain;
  single.name = "leapfrog single";
  single.precision = Precision::single;
  mixed.name = "leapfrog mixed";
  mixed.precision = Precision::mixed;
  return {product, plain, exponential, fourth, classical, single, mixed};
}

}  // namespace

const Method& engine() {
  return methods().front();
}

const std::vector<Method>& methods() {
  static const std::vector<Method> all = make_methods();
  return all;
}

void integrate(const Box& box, const Method& method, const Motion& start, double dt,
               std::uint64_t steps, std::uint64_t every, const Visit& visit) {
  Motion begin = start;
  if (method.staggered) {
    RungeKutta back(box, start, -dt / 2);
    back.step();
    begin.velocity = back.motion().velocity;
  }
  switch (method.kind) {
    case Method::Kind::engine:
      return run(Engine(box, begin, dt), steps, every, visit);
    case Method::Kind::runge_kutta:
      return run(RungeKutta(box, begin, dt), steps, every, visit);
    case Method::Kind::splitting:
      break;
  }
  switch (method.precision) {
    case Precision::twofold:
      return run(Splitting<double, double>(box, method, begin, dt), steps, every, visit);
    case Precision::single:
      return run(Splitting<float, float>(box, method, begin, dt), steps, every, visit);
    case Precision::mixed:
      return run(Splitting<double, float>(box, method, begin, dt), steps, every, visit);
  }
}

double energy(const Box& box, const Method& method, const Motion& motion, double dt) {
  Eigen::Matrix3Xd v = motion.velocity;
  if (method.staggered) v += dt / 2 * forces(box, motion.position);
  return 0.5 * v.squaredNorm() + potential_energy(box, motion.position);
}

}  // namespace shearcell::accuracy
