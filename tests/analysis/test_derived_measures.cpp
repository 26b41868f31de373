// SPDX-License-Identifier: GPL-3.0-or-later
// Results come back from what is kept bit by bit, and change only together with analysis_version.
#include "analysis/derived_measures.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "analysis/error.hpp"
#include "provenance/sha256.hpp"
#include "tests/analysis/packings.hpp"

namespace shearcell::testing {
namespace {

// Positions from integers alone, so that no other code has a part in them: a jittered lattice.
Packing pinned_packing() {
  Packing p = lattice(Lattice::fcc, 5);
  std::uint64_t state = 1;
  for (double& x : p.grains.reshaped()) {
    state = state * 6364136223846793005U + 1442695040888963407U;
    x += (static_cast<double>(state >> 40) * 0x1p-24 - 0.5) * 0.0125;
  }
  return p;
}

Analysis pinned_analysis() {
  const Packing p = pinned_packing();
  return analyse(p.cell, p.pose, p.grains);
}

TEST(DerivedMeasures, ResultsArePinnedToTheVersion) {
  const nlohmann::json result = scalar_measures().from(pinned_analysis());
  const std::string hash = sha256_hex(encode_result(result));
  // When this fails the results have changed: raise analysis_version, then state the new hash.
  ASSERT_EQ(analysis_version, 1U);
  EXPECT_EQ(hash, "5acc04eedc5b4d7f6f3608cd7fd171b7d6e7147b83f53501da391815a9e72eef")
      << result.dump(1);
  EXPECT_EQ(scalar_measures().key(),
            "scalars {\"connecting_face\":0.01,\"crystalline_phi_local\":0.72,"
            "\"interior_distance_d\":1.5,\"q6_fcc\":0.575,\"q6_hcp\":0.485,\"q6_tolerance\":0.02,"
            "\"rough_wall_surface_d\":0.375}");
}

TEST(DerivedMeasures, EveryScalarComesBackBitByBit) {
  const Analysis analysis = pinned_analysis();
  const Measures& m = analysis.measures;
  const nlohmann::json kept = scalar_measures().from(analysis);
  const Measures back = read_measures(decode_result(encode_result(kept)));
  for (const auto scalar :
       {&Measures::phi, &Measures::phi_uncorrected, &Measures::crystalline_percent,
        &Measures::fcc_percent, &Measures::hcp_percent, &Measures::mean_overlap,
        &Measures::contacts_per_grain}) {
    EXPECT_EQ(std::bit_cast<std::uint64_t>(back.*scalar), std::bit_cast<std::uint64_t>(m.*scalar));
  }
  for (const auto count : {&Measures::grains, &Measures::interior_grains, &Measures::crystallites,
                           &Measures::largest_crystallite}) {
    EXPECT_EQ(back.*count, m.*count);
  }
}

TEST(DerivedMeasures, EveryKindOfNumberComesBack) {
  for (const double x : {0.1, -0.0, 1e-320, 1.7976931348623157e308, 1.0 / 3, 65504.0,
                         std::numeric_limits<double>::infinity()}) {
    const auto back = decode_result(encode_result(nlohmann::json(x))).get<double>();
    EXPECT_EQ(std::bit_cast<std::uint64_t>(back), std::bit_cast<std::uint64_t>(x)) << x;
  }
  EXPECT_TRUE(std::isnan(decode_result(encode_result(nlohmann::json(std::nan("")))).get<double>()));
}

// What crystallite tracking will keep: an entry per grain, beside the scalars, from one analysis.
TEST(DerivedMeasures, ArraysOfGrainsCanBeKept) {
  const DerivedMeasure structures{
      "structures", nlohmann::json::object(), [](const Analysis& a) {
        std::vector<std::uint8_t> kinds;
        for (const Structure s : a.grains.structure) kinds.push_back(static_cast<std::uint8_t>(s));
        return nlohmann::json{{"structure", nlohmann::json::binary(kinds)}};
      }};
  const Analysis analysis = pinned_analysis();
  const std::vector<std::byte> bytes = encode_result(structures.from(analysis));
  EXPECT_LT(bytes.size(), analysis.grains.structure.size() + 32);
  const nlohmann::json back = decode_result(bytes);
  const auto& kinds = back.at("structure").get_binary();
  ASSERT_EQ(kinds.size(), analysis.grains.structure.size());
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    EXPECT_EQ(static_cast<Structure>(kinds[i]), analysis.grains.structure[i]);
  }
}

TEST(DerivedMeasures, OtherBytesAreRefused) {
  EXPECT_THROW(decode_result({}), AnalysisError);
  const std::vector<std::byte> broken(3, std::byte{0xff});
  EXPECT_THROW(decode_result(broken), AnalysisError);
  EXPECT_THROW(read_measures(nlohmann::json::object()), AnalysisError);
  EXPECT_THROW(read_measures(nlohmann::json::array({1})), AnalysisError);
}

}  // namespace
}  // namespace shearcell::testing
