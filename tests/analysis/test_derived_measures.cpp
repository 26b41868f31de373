// SPDX-License-Identifier: GPL-3.0-or-later
// Cached results are restored bit by bit, and change only together with analysis_version.
#include "analysis/measures.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "provenance/errors.hpp"
#include "provenance/sha256.hpp"
#include "tests/analysis/packings.hpp"

namespace shearcell::test {
namespace {

// Of positions from integers alone, so that no other code has a part in them: a jittered lattice.
Analysis pinned_analysis() {
  Packing p = lattice(Lattice::fcc, 5);
  std::uint64_t state = 1;
  for (double& x : p.grains.reshaped()) {
    state = state * 6364136223846793005U + 1442695040888963407U;
    x += (static_cast<double>(state >> 40) * 0x1p-24 - 0.5) * 0.0125;
  }
  return analyse(checkpoint_of(p));
}

nlohmann::json scalars_of(const Analysis& analysis) {
  return provider("scalars").compute({&analysis});
}

nlohmann::json crystallites_of(const Analysis& analysis) {
  return provider("crystallites").compute({&analysis});
}

TEST(DerivedMeasures, ResultsArePinnedToTheVersion) {
  const nlohmann::json result = scalars_of(pinned_analysis());
  const std::string hash = sha256_hex(encode_result(result));
  // When this fails the results have changed: raise analysis_version, then state the new hash.
  ASSERT_EQ(analysis_version, 2U);
  EXPECT_EQ(hash, "20681c6fb6351d74f819276ed6e57db8cc5e725a96c76234e52818dbf1d320ed")
      << result.dump(1);
  EXPECT_EQ(provider("scalars").key(),
            "scalars {\"connecting_face\":0.01,\"crystalline_phi_local\":0.72,"
            "\"interior_distance_d\":1.5,\"q6_fcc\":0.575,\"q6_hcp\":0.485,\"q6_tolerance\":0.02,"
            "\"rough_wall_surface_d\":0.375}");
}

Measures read_scalars(const nlohmann::json& result) {
  Measures measures;
  provider("scalars").read(result, measures);
  return measures;
}

TEST(DerivedMeasures, EveryScalarIsRestoredBitByBit) {
  const Analysis analysis = pinned_analysis();
  const PackingMeasures& m = analysis.measures;
  const nlohmann::json kept = scalars_of(analysis);
  const Measures back = read_scalars(decode_result(encode_result(kept)));
  // Each of PackingMeasures, and N, which is not a measure.
  EXPECT_EQ(kept.size() * sizeof(double), sizeof(PackingMeasures)) << "a member is not kept";
  EXPECT_EQ(back.numbers.size() + 1, kept.size());
  for (const auto& [name, value] : back.numbers) {
    EXPECT_EQ(std::bit_cast<std::uint64_t>(value),
              std::bit_cast<std::uint64_t>(kept.at(name).get<double>()))
        << name;
  }
  EXPECT_EQ(back.number("phi"), m.phi);
  EXPECT_EQ(back.number("hcp_percent"), m.hcp_percent);
  EXPECT_EQ(back.number("largest_crystallite"), static_cast<double>(m.largest_crystallite));
}

TEST(DerivedMeasures, EveryKindOfNumberIsRestored) {
  for (const double x : {0.1, -0.0, 1e-320, 1.7976931348623157e308, 1.0 / 3, 65504.0,
                         std::numeric_limits<double>::infinity()}) {
    const auto back = decode_result(encode_result(nlohmann::json(x))).get<double>();
    EXPECT_EQ(std::bit_cast<std::uint64_t>(back), std::bit_cast<std::uint64_t>(x)) << x;
  }
  EXPECT_TRUE(std::isnan(decode_result(encode_result(nlohmann::json(std::nan("")))).get<double>()));
}

CrystalliteMap read_crystallites(const nlohmann::json& result) {
  Measures measures;
  provider("crystallites").read(result, measures);
  return measures.crystallite_map.value();
}

TEST(DerivedMeasures, CrystallitesAreRestoredBitByBit) {
  const Analysis analysis = pinned_analysis();
  const CrystalliteMap& map = analysis.crystallites;
  ASSERT_FALSE(map.grain.empty());
  const std::vector<std::byte> bytes = encode_result(crystallites_of(analysis));
  const CrystalliteMap back = read_crystallites(decode_result(bytes));
  EXPECT_EQ(back.grain, map.grain);
  EXPECT_EQ(back.label, map.label);
  EXPECT_EQ(back.size, map.size);
  EXPECT_EQ(back.centre, map.centre);
  EXPECT_EQ(back.width, map.width);
  for (std::size_t k = 0; k < map.grain.size(); ++k) {
    const auto id = static_cast<std::size_t>(map.grain[k]);
    EXPECT_EQ(analysis.grains.crystallite[id], map.label[k]);
  }
}

TEST(DerivedMeasures, InconsistentCrystallitesAreRejected) {
  const nlohmann::json good = crystallites_of(pinned_analysis());
  for (const char* key : {"grain", "label", "size", "centre_d", "width_d"}) {
    nlohmann::json bad = good;
    bad.erase(key);
    EXPECT_THROW(read_crystallites(bad), AnalysisError) << key;
    bad = good;
    bad[key] = nlohmann::json::binary({1, 0, 0, 0});
    EXPECT_THROW(read_crystallites(bad), AnalysisError) << key;
  }
  nlohmann::json bad = good;
  std::vector<std::uint8_t> labels = good.at("label").get_binary();
  labels[3] = 0x80;
  bad["label"] = nlohmann::json::binary(labels);
  EXPECT_THROW(read_crystallites(bad), AnalysisError) << "a negative label";
  bad = good;
  std::vector<std::uint8_t> sizes = good.at("size").get_binary();
  sizes.insert(sizes.end(), 4, 0);
  bad["size"] = nlohmann::json::binary(sizes);
  bad["centre_d"].push_back({1, 2, 3});
  EXPECT_THROW(read_crystallites(bad), AnalysisError) << "a crystallite without grains";
  bad = good;
  bad["centre_d"][0][1] = std::nan("");
  EXPECT_THROW(read_crystallites(bad), AnalysisError) << "a centre that is no place";
  bad = good;
  bad["width_d"] = 0;
  EXPECT_THROW(read_crystallites(bad), AnalysisError) << "a cell without width";
}

TEST(DerivedMeasures, AMeasureSaysWhichEarlierCheckpointItNeeds) {
  for (const Provider& one : all_providers()) {
    for (const Measure& measure : one.measures) {
      EXPECT_EQ(&provider_of(measure), &one) << measure.name << " is the name of two measures";
    }
  }
  EXPECT_EQ(provider_of(*find_measure("d2min_10_cycles_d2")).cycles_back, 10U);
  EXPECT_EQ(provider_of(*find_measure("msd_100_cycles_d2")).cycles_back, 100U);
  EXPECT_EQ(provider_of(*find_measure("msd_1_cycle_d2")).cycles_back, 1U);
  EXPECT_EQ(provider_of(*find_measure("phi")).cycles_back, 0U);
}

TEST(DerivedMeasures, AProviderComputesTheMeasuresThatItLists) {
  const Checkpoint checkpoint = checkpoint_of(jammed(300, true, 0, 5));
  const Analysis analysis = analyse(checkpoint);
  const RunFacts run;
  std::size_t providers = 0;
  for (const Provider& one : all_providers()) {
    if (one.from != ComputedFrom::checkpoint) continue;
    const auto earlier = [&] { return &checkpoint; };
    const auto result = one.compute({&analysis, &checkpoint, earlier, nullptr, &run});
    Measures found;
    one.read(result, found);
    EXPECT_EQ(found.numbers.size() + found.curves.size() + found.of_grains.size(),
              one.measures.size())
        << one.name;
    for (const auto& [name, values] : found.of_grains) EXPECT_EQ(values.size(), 300U) << name;
    EXPECT_TRUE(found.of_grains.empty() || found.of_grains.size() == one.measures.size())
        << one.name << ": results with values of each grain are not kept";
    ++providers;
  }
  EXPECT_GT(providers, 10U);
}

TEST(DerivedMeasures, OtherBytesAreRejected) {
  EXPECT_THROW(decode_result({}), AnalysisError);
  const std::vector<std::byte> broken(3, std::byte{0xff});
  EXPECT_THROW(decode_result(broken), AnalysisError);
  EXPECT_THROW(read_scalars(nlohmann::json::object()), AnalysisError);
  EXPECT_THROW(read_scalars(nlohmann::json::array({1})), AnalysisError);
  nlohmann::json forged = scalars_of(pinned_analysis());
  forged.at("phi") = 1e300;
  EXPECT_THROW(read_scalars(forged), AnalysisError);
}

}  // namespace
}  // namespace shearcell::test
