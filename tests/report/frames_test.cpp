// SPDX-License-Identifier: GPL-3.0-or-later
// A frame is decoded to within its stated step.
#include "experiments/report/packings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

namespace shearcell {
namespace {

constexpr int kFrameGrains = 500;

/// Grains anywhere in a tilted cell, some beyond the period, and a wall grain on each side.
Checkpoint tilted_checkpoint() {
  Checkpoint checkpoint;
  checkpoint.theta = 0.0833;
  checkpoint.cell.width = 17;
  checkpoint.cell.depth = 12;
  checkpoint.cell.bottom = 0;
  checkpoint.cell.top = 30;
  for (const WallSide side : {WallSide::left, WallSide::right, WallSide::bottom, WallSide::top}) {
    checkpoint.cell.wall_grains.push_back({side, {3.25, 5.5, 11.75}});
  }
  checkpoint.state.wall_height = 1.5;
  checkpoint.state.position.resize(3, kFrameGrains);
  std::mt19937 random(7);  // NOLINT: the same in each run
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < kFrameGrains; ++i) {
    checkpoint.state.position.col(i) << 17 * unit(random) - 1.5, 1.5 + 28.5 * unit(random),
        12 * (3 * unit(random) - 1);
  }
  return checkpoint;
}

// Two exact quantities, a number, a class, a quantity, and one on a logarithmic scale with unknown
// values.
std::vector<GrainField> fields_of_each() {
  const auto field = [](const char* name, double low, double high) {
    return GrainField{find_measure(name, MeasureKind::grains), low, high};
  };
  std::vector<GrainField> fields = {field("phi_local", 0.55, 0.74),   field("q6", 0.2, 0.6),
                                    field("crystallite", 0, 0),       field("structure", 0, 0),
                                    field("grain_pressure_Pa", 0, 3), field("d2min_d2", 1e-6, 1)};
  for (int i = 0; i < kFrameGrains; ++i) {
    fields[0].value.push_back(0.5 + 0.24 * i / kFrameGrains);
    fields[1].value.push_back(i == 7 ? std::nan("") : 0.6 - 0.5 * i / kFrameGrains);
    fields[2].value.push_back(i % 5);
    fields[3].value.push_back(i % 7);
    fields[4].value.push_back(4.0 * i / kFrameGrains - 0.5);  // below and above the range too
    fields[5].value.push_back(i % 7 == 0 ? std::nan("") : std::pow(10, -6.0 * i / kFrameGrains));
  }
  return fields;
}

class Frames : public testing::Test {
 protected:
  const Checkpoint checkpoint_ = tilted_checkpoint();
  const WallPose pose_ =
      wall_pose(checkpoint_.cell, checkpoint_.theta, checkpoint_.state.wall_height);
  const std::vector<GrainField> fields_ = fields_of_each();
  const EncodedFrame frame_ = encode_frame(checkpoint_, pose_, fields_);
  static constexpr std::size_t kAll = kFrameGrains + 4;

  int byte(std::size_t at) const { return std::to_integer<int>(frame_.bytes[at]); }
  double word(std::size_t at) const { return byte(2 * at) + 256 * byte(2 * at + 1); }
  double coordinate(std::size_t sphere, Eigen::Index axis) const {
    return frame_.origin[axis] +
           frame_.step[axis] * word(static_cast<std::size_t>(axis) * kAll + sphere);
  }
};

TEST_F(Frames, RoundPositionsToHalfAStep) {
  const Eigen::Matrix3Xd walls = wall_grain_positions(checkpoint_.cell, pose_);
  for (std::size_t i = 0; i < kAll; ++i) {
    Eigen::Vector3d exact =
        i < kFrameGrains ? checkpoint_.state.position.col(static_cast<Eigen::Index>(i)).eval()
                         : walls.col(static_cast<Eigen::Index>(i) - kFrameGrains).eval();
    exact.z() -= 12 * std::floor(exact.z() / 12);
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(coordinate(i, axis), exact[axis], 0.5 * frame_.step[axis] * (1 + 1e-9))
          << "sphere " << i;
    }
  }
  EXPECT_LT(frame_.step.maxCoeff(), 30.0 / 65534);
}

TEST_F(Frames, KeepWallGrainsOnTheirTiltedWalls) {
  // Left and right walls are displaced by (y - top) tan(theta).
  const double displaced = 3.25 + (5.5 - 30) * std::tan(0.0833);
  EXPECT_NEAR(coordinate(kFrameGrains, 0), displaced, frame_.step.x());
  EXPECT_NEAR(coordinate(kFrameGrains + 2, 1), 5.5 + 1.5, frame_.step.y());
}

TEST_F(Frames, KeepExactMeasuresInSixteenBits) {
  const auto value = [&](std::size_t field, std::size_t i) {
    return word(3 * kAll + field * kFrameGrains + i);
  };
  for (std::size_t i = 0; i < kFrameGrains; ++i) {
    EXPECT_NEAR(value(0, i) / 65534, fields_[0].value[i], 0.501 / 65534);
    if (i == 7) {
      EXPECT_EQ(value(1, i), 65535);
    } else {
      EXPECT_NEAR(value(1, i) / 65534, fields_[1].value[i], 0.501 / 65534);
    }
    EXPECT_EQ(value(2, i), fields_[2].value[i]);
  }
}

TEST_F(Frames, KeepOtherFieldsToHalfAStepOfTheirRange) {
  const auto value = [&](std::size_t field, std::size_t i) {
    return byte(6 * kAll + (3 + field) * kFrameGrains + i);  // the exact ones have two bytes
  };
  for (std::size_t i = 0; i < kFrameGrains; ++i) {
    EXPECT_EQ(value(3, i), fields_[3].value[i]);
    const double pressure = std::clamp(fields_[4].value[i], 0.0, 3.0);
    EXPECT_NEAR(value(4, i) / 254.0 * 3, pressure, 3 * 0.501 / 254);
    if (i % 7 == 0) {
      EXPECT_EQ(value(5, i), 255);
    } else {
      EXPECT_NEAR(6 * value(5, i) / 254.0 - 6, std::log10(fields_[5].value[i]), 6 * 0.501 / 254);
    }
  }
}

TEST_F(Frames, HaveTheSizeThatTheBudgetAssumes) {
  EXPECT_EQ(frame_.bytes.size(), 6 * kAll + 9 * kFrameGrains);
  EXPECT_EQ(frame_size_in_page(kFrameGrains, 4, 9), (frame_.bytes.size() + 2) / 3 * 4);
}

}  // namespace
}  // namespace shearcell
