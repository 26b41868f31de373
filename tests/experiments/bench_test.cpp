// SPDX-License-Identifier: GPL-3.0-or-later
// Results of `bench`: convergence of integrators on closed forms, speed compared with the limits of
// the machine, and outcomes of hard cases; and the overlap that `plan` predicts.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <set>
#include <stdexcept>

#include "experiments/bench/accuracy/closed_forms.hpp"
#include "experiments/bench/packing.hpp"
#include "experiments/bench/speed.hpp"
#include "experiments/bench/stability/stability.hpp"
#include "experiments/manifest/conversion.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

using namespace accuracy;  // NOLINT(google-build-using-namespace)

const Scene kScene = shear_scene(Parameters{});
const double kStep = kScene.time_step;  // Table I's

// A contact that opens or closes bends the force, and a step over that bend has an error of dt^2 in
// the velocity: every method is then of second order.
TEST(Accuracy, OrderIsThatOfTheoryForEveryClosedForm) {
  for (const ClosedForm& form : closed_forms(kScene, true)) {
    for (const Method& m : methods()) {
      const double order = fitted_order(form, m, kStep);
      std::printf("%s, %s: order %.2f\n", form.title.c_str(), m.name.c_str(), order);
      const double smooth = m.name == "engine" ? 2 : 4;
      EXPECT_NEAR(order, form.irregular ? 2 : smooth, form.irregular ? 0.35 : 0.25)
          << form.name << ", " << m.name;
    }
  }
}

// Frequency [rad/s] of the longitudinal wave with n periods in a row of grains along z whose
// neighbours overlap, as the engine finds it without drag over 500 steps.
double found_row_frequency(int grains, int n) {
  constexpr double overlap = 0.003, amplitude = 1e-6;
  constexpr double across = 1 - 2 * overlap;  // the planes of the duct hold each grain as deep
  Eigen::Matrix3Xd rest(3, grains);
  Eigen::RowVectorXd wave(grains);
  for (int i = 0; i < grains; ++i) {
    rest.col(i) << across / 2, across / 2, i * (1 - overlap);
    wave[i] = std::cos(2 * std::numbers::pi * n * i / grains);
  }
  wave.normalize();
  Packing box =
      bench::placed(contacts_only(kScene.stiffness), {}, {across, across, grains * (1 - overlap)});
  box.state.position = rest;
  box.state.position.row(2) += amplitude * wave;
  box.state.velocity = Eigen::Matrix3Xd::Zero(3, grains);
  std::vector<double> x;
  integrate(box, methods().front(), kStep, 500, [&](std::uint64_t, const State& state) {
    x.push_back(wave.dot(state.position.row(2) - rest.row(2)));
  });
  double both = 0, square = 0;  // cos(w dt) = sum x_k (x_(k+1) + x_(k-1)) / (2 sum x_k^2)
  for (std::size_t k = 1; k + 1 < x.size(); ++k) {
    both += x[k] * (x[k + 1] + x[k - 1]);
    square += x[k] * x[k];
  }
  return std::acos(both / (2 * square)) / kStep;
}

// sin(w' dt/2) = w dt/2, with w = 2 sqrt(k/m) sin(pi n / grains)
TEST(Accuracy, EngineHasTheDispersionOfTheLeapfrog) {
  for (int n = 1; n <= 6; ++n) {
    const double exact = 2 * std::sqrt(kScene.stiffness) * std::sin(std::numbers::pi * n / 12);
    EXPECT_NEAR(std::sin(found_row_frequency(12, n) * kStep / 2) / (exact * kStep / 2), 1, 1e-7)
        << n;
  }
}

TEST(Overlap, IsAsAPlanPredicts) {
  struct Case {
    std::uint64_t grains;
    double pressure, stiffness;
    MovingWall moving;
  };
  for (const Case& c : {Case{600, 1, 1, MovingWall::bottom}, Case{600, 1, 1, MovingWall::top},
                        Case{600, 2, 1, MovingWall::bottom}, Case{600, 1, 4, MovingWall::bottom},
                        Case{2000, 1, 1, MovingWall::bottom}}) {
    Parameters p;
    p.grains = c.grains;
    p.pressure_Pa *= c.pressure;
    p.stiffness_N_per_m *= c.stiffness;
    p.settle_time_step_s /= std::sqrt(c.stiffness);
    p.moving_wall = c.moving;
    const bench::Packing packing = bench::settled_packing(p, 1);
    const double found =
        bench::numbers_of(packing.cell, packing.scene, 0, packing.state).mean_overlap;
    std::printf("N = %d, P x %g, k x %g: %.3e d, expected %.3e d\n", static_cast<int>(c.grains),
                c.pressure, c.stiffness, found, expected_overlap(p));
    EXPECT_NEAR(found / expected_overlap(p), 1, 0.15);
  }
}

TEST(Speed, WorkOfAStepGrowsWithItsSlots) {
  for (const std::size_t lanes : {1U, 2U, 4U, 8U}) {
    const auto grains = static_cast<double>(lanes);
    const bench::StepWork none = bench::step_work(lanes, 0);
    const bench::StepWork ten = bench::step_work(lanes, 10);
    // An offset of four bytes in each slot of each lane, and at least a position's difference (3)
    // and its square (3) for each vector.
    EXPECT_NEAR(ten.bytes - none.bytes, 40, 1e-9) << lanes;
    EXPECT_GE(ten.vector_operations - none.vector_operations, 10 * 6 / grains) << lanes;
    // Two positions, two velocities, and the reference in single precision.
    EXPECT_GE(none.bytes, 2 * 24 + 2 * 24 + 12) << lanes;
    EXPECT_LT(ten.footprint, ten.bytes) << lanes;
  }
}

TEST(Speed, NoKernelIsFasterThanTheMachine) {
  bench::SpeedOptions options;
  options.sizes = {200};
  options.repeats = 1;
  options.seconds_per_repeat = 0.05;
  for (const bench::SpeedResult& result : bench::measure_speed(options)) {
    SCOPED_TRACE(result.simd);
    EXPECT_GT(result.fastest_rate, 0);
    // Twice, since the limits were measured at another moment of a machine that others use too.
    EXPECT_LT(result.fastest_rate, 2 * result.arithmetic_limit);
    EXPECT_LT(result.fastest_rate, 2 * result.memory_limit);
    // Six neighbours in a dense packing, at the least.
    EXPECT_GT(result.work.bytes, bench::step_work(1, 6).bytes - 9);
    EXPECT_LT(result.work.bytes, 300);
  }
}

// A prime number of grains beyond those that the pressure can lift: two packings side by side.
TEST(Speed, OfAPackingRepeatedAlongTheDepth) {
  const bench::SpeedResult result = bench::measure_speed({.sizes = {18211},
                                                          .threads = {1},
                                                          .repeats = 1,
                                                          .seconds_per_repeat = 0.01,
                                                          .report = {}})
                                        .front();
  EXPECT_EQ(result.grains, 18212U);
  EXPECT_GT(result.median_rate, 0);
}

TEST(HardCases, HaveUniqueNamesAndExpectations) {
  std::set<std::string> names;
  for (const stability::HardCase& hard : stability::hard_cases(true)) {
    EXPECT_TRUE(names.insert(hard.name).second) << hard.name;
    EXPECT_FALSE(hard.done.empty() || hard.expected.empty()) << hard.name;
  }
}

TEST(HardCases, AreReportedHoweverTheyEnd) {
  using stability::Answer;
  const auto outcome_of = [](std::function<Answer()> run, double seconds = 60) {
    return stability::compute_apart({"", "", "", std::move(run)}, seconds);
  };
  const std::string text(200'000, 'x');
  const Answer right = outcome_of([&] { return Answer{true, text}; });
  EXPECT_TRUE(right.as_expected);
  EXPECT_EQ(right.text, text);
  const std::pair<Answer, std::string> others[] = {
      {outcome_of([] {
         return Answer{false, "off"};
       }),
       "off"},
      {outcome_of([]() -> Answer { std::abort(); }), "signal 6"},
      {outcome_of(
           []() -> Answer {
             for (;;) sleep(1);
           },
           0.3),
       "hangs"},
      {outcome_of([]() -> Answer { throw std::runtime_error("no such thing"); }),
       "threw: no such thing"},
      {outcome_of([]() -> Answer { std::_Exit(0); }), "ended without an outcome"}};
  for (const auto& [outcome, found] : others) {
    EXPECT_FALSE(outcome.as_expected);
    EXPECT_TRUE(has(outcome.text, found));
  }
}

TEST(HardCases, RejectAnUnknownName) {
  using stability::unknown_case;
  EXPECT_EQ(unknown_case("vacancy"), "");
  EXPECT_EQ(unknown_case("limit"), "") << "four begin so";
  EXPECT_EQ(unknown_case("vacanzy"), "no hard case is named 'vacanzy', the nearest is vacancy");
}

}  // namespace
}  // namespace shearcell::test
