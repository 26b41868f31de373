// SPDX-License-Identifier: GPL-3.0-or-later
// How often each kind of claim is decided, by simulation: made-up runs of a stated spread go
// through the estimates and verdicts of the program. Prints a row for each kind:
//   test_analysis --gtest_filter='Power.*'
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/growth.hpp"
#include "analysis/published.hpp"
#include "analysis/statistics.hpp"
#include "analysis/verdict.hpp"
#include "experiments/manifest/manifest.hpp"
#include "tests/analysis/made_up_runs.hpp"

namespace shearcell::test {
namespace {

/// A data set of `runs` runs, or pairs, or runs per group, in which the quantity is `truth`.
using Simulated =
    std::function<std::optional<Estimate>(std::uint32_t sample, std::size_t runs, double truth)>;

std::vector<double> numbers(std::uint32_t sample, std::size_t runs, double mean, double spread) {
  std::vector<double> values = normal_numbers(sample, runs);
  for (double& value : values) value = mean + spread * value;
  return values;
}

/// One group, or pairs.
Simulated one_group(double spread) {
  return [=](std::uint32_t sample, std::size_t runs, double truth) {
    return mean_of(numbers(sample, runs, truth, spread));
  };
}

Simulated two_groups(double spread) {
  return [=](std::uint32_t sample, std::size_t runs, double truth) {
    return difference_of_means(numbers(2 * sample, runs, truth, spread),
                               numbers(2 * sample + 1, runs, 0, spread));
  };
}

/// log2 of the cycle is normal; runs end at the 0.9 quantile of the earlier group.
Simulated onset_cycles(double spread) {
  const auto waits = [=](std::uint32_t sample, std::size_t runs, double mean) {
    std::vector<CensoredValue> all;
    for (const double log_cycle : numbers(sample, runs, mean, spread)) {
      const double end = 1.2816 * spread;
      all.push_back({std::exp2(std::min(log_cycle, end)), log_cycle > end});
    }
    return all;
  };
  return [=](std::uint32_t sample, std::size_t runs, double truth) {
    return log2_wait_ratio(waits(2 * sample, runs, truth / 2),
                           waits(2 * sample + 1, runs, -truth / 2));
  };
}

/// About 700 crystallites a run, most of them small; ln(critical size) differs from run to run.
Simulated critical_sizes(double published, double spread) {
  return [=](std::uint32_t sample, std::size_t runs, double truth) {
    std::vector<GrowthBySize> all;
    for (const double shift : numbers(sample, runs, 0, spread)) {
      const double critical = (published + truth) * std::exp(shift);
      GrowthBySize counts;
      for (std::int32_t size = 1; size <= 40; ++size) {
        const double grow = 1 / (1 + std::sqrt(critical / size));
        for (std::int32_t k = 0; k < 400 / (size * size) + 3; ++k) {
          const auto run = static_cast<std::uint32_t>(all.size());
          const auto id = static_cast<std::uint32_t>(1000 * size + k);
          ++(uniform_pair({sample, run, id, 3}, 5)[0] < grow ? counts[size].grew
                                                             : counts[size].shrank);
        }
      }
      all.push_back(counts);
    }
    std::optional<Estimate> found = GrowthCurve(all).critical_size();
    if (found) {
      found->value -= published;
      found->interval.low -= published;
      found->interval.high -= published;
    }
    return found;
  };
}

/// Share of 20 nuclei a run in the upper third less that in the lower third.
Simulated shares(std::size_t nuclei) {
  return [=](std::uint32_t sample, std::size_t runs, double truth) {
    std::vector<double> excess;
    for (std::uint32_t run = 0; run < runs; ++run) {
      double sum = 0;
      for (std::uint32_t k = 0; k < nuclei; ++k) {
        const double u = uniform_pair({sample, run, k, 5}, 11)[0];
        sum += u < 1.0 / 3 + truth / 2 ? 1 : u > 2.0 / 3 + truth / 2 ? -1 : 0;
      }
      excess.push_back(sum / static_cast<double>(nuclei));
    }
    return bootstrapped(runs, mean_over(excess));
  };
}

struct Kind {
  const char* quantity;  ///< and the unit of its margin
  double margin;
  const char* spread;
  Simulated simulate;
  Relation claimed = Relation::same;
  double scale = 1;  ///< the margin in units of the quantity
  std::uint32_t samples = 1000;
};

/// The margin of a claim of a manifest in experiments/.
double margin_of(const std::string& experiment, const std::string& claim) {
  const auto folder = std::filesystem::path(SHEARCELL_TEST_DATA) / ".." / ".." / "experiments";
  const Manifest manifest = load_manifest(folder / (experiment + ".yaml"));
  return std::ranges::find(manifest.claims, claim, &ClaimSpec::id)->margin;
}

std::vector<Kind> kinds() {
  const double margin_early_phi = margin_of("drag", "S2.phi");
  return {
      {"relative fall of phi_u over a hundredfold k", margin_of("spring_constant", "S1.fall"),
       "0.001 a system", one_group(0.001)},
      {"change of phi over a hundredfold k", margin_of("spring_constant", "S1.phi"),
       "0.0006 a system", one_group(0.0006)},
      {"phi, mean over cycles 1 to 15", margin_early_phi, "0.0005 a pair", one_group(0.0005)},
      {"phi, mean over cycles 1 to 15", margin_early_phi, "0.0005 a run, two groups",
       two_groups(0.0005)},
      {"phi gained by pauses at rest, mean over cycles 1 to 15", margin_of("relaxation", "B5.rest"),
       "0.0005 a pair", one_group(0.0005), Relation::higher},
      {"percentage crystalline, mean over phi from 0.646 to 0.67 [points]",
       margin_of("drag", "S2.percentage"), "2 points a run, two groups", two_groups(2)},
      {"mean overlap, contacts per grain, relative", margin_of("moving_wall", "S4.overlap"),
       "1.5 % a run, two groups", two_groups(0.015)},
      {"phi at the onset", margin_of("onset_amplitude", "S5a.onset"), "0.002 a run",
       one_group(0.002)},
      {"cycle of the onset, log2 of the ratio", margin_of("drag", "S2.onset"),
       "a factor of 1.5 a run, two groups", onset_cycles(0.6), Relation::same, 1, 400},
      {"N_inves, relative", margin_of("system_size", "S5b.interior_7900"), "1 % a run",
       one_group(0.01)},
      {"critical size, of the published size", margin_critical_size, "a quarter a run",
       critical_sizes(16, 0.25), Relation::same, 16, 100},
      {"share of nuclei in one part of the cell less that in another", margin_share,
       "20 nuclei a run", shares(20), Relation::same, 1, 200},
      {"share of nuclei in one part of the cell less that in another", margin_share,
       "the same, claimed above", shares(20), Relation::higher, 1, 200}};
}

/// The number that the program would print: from the spread that data sets of 30 runs show.
std::size_t runs_needed(const Kind& kind, double truth, bool both_sides) {
  constexpr std::uint32_t sets = 8;
  Estimate design;
  for (std::uint32_t s = 0; s < sets; ++s) {
    const Estimate found = kind.simulate(300000 + s, 30, truth).value();
    design.groups = found.groups;
    design.spread += found.spread / sets;
  }
  return runs_to_resolve(design, kind.margin * kind.scale, both_sides).value();
}

/// Shares of data sets [%].
struct Rates {
  double agrees = 0;
  double differs = 0;
};

Rates rates(const Kind& kind, std::size_t runs, double truth, std::uint32_t first) {
  const Claim claim = {"", kind.margin * kind.scale, kind.claimed};
  std::uint32_t agrees = 0, differs = 0;
  for (std::uint32_t s = 0; s < kind.samples; ++s) {
    const Verdict verdict = decide(claim, "", kind.simulate(first + s, runs, truth), runs, "");
    const Ruling ruling = verdict.ruling;
    agrees += ruling == Ruling::agrees || ruling == Ruling::supported ? 1 : 0;
    differs += ruling == Ruling::differs || ruling == Ruling::refuted ? 1 : 0;
  }
  return {100.0 * agrees / kind.samples, 100.0 * differs / kind.samples};
}

TEST(Power, OfEveryKindOfClaimAtItsNumberOfRuns) {
  fmt::print(
      "| quantity | margin | spread assumed | runs | decided if equal | at twice the margin "
      "| agrees at the margin |\n|---|---|---|---|---|---|---|\n");
  for (const Kind& kind : kinds()) {
    const double margin = kind.margin * kind.scale;
    const bool within = kind.claimed == Relation::same;
    const std::size_t predicted =
        std::max(runs_needed(kind, 0, within), runs_needed(kind, 2 * margin, false));
    std::size_t runs = predicted;
    Rates none, twice;
    for (;; runs += 1 + runs / 10) {
      none = rates(kind, runs, 0, 0);
      twice = rates(kind, runs, 2 * margin, 100000);
      if (!within) std::swap(none.agrees, none.differs), std::swap(twice.agrees, twice.differs);
      if (none.agrees >= 90 && twice.differs >= 90) break;
      ASSERT_LT(runs, 2 * predicted) << kind.quantity;
    }
    const double at = rates(kind, runs, margin, 200000).agrees;
    fmt::print("| {} | {:.3g} | {} | {} | {:.0f} % | {:.0f} % | {:.0f} % |\n", kind.quantity,
               kind.margin, kind.spread, runs, none.agrees, twice.differs, at);
    EXPECT_LE(runs, predicted + 1 + predicted / 5) << kind.quantity;
    EXPECT_LE(at, 5 + 2 * std::sqrt(5.0 * 95.0 / kind.samples)) << "2 sigma of the simulation";
  }
}

// The claims of S7 in experiments/results/PLAN.md: one look at 16 packings. At the first look
// packings had 24 nuclei of these amplitudes, and 6 at ten times the stiffness, before 10 % were
// crystalline.
TEST(SecondLook, PowerOfTheSharesOfNuclei) {
  struct Planned {
    const char* id;
    std::size_t nuclei;
    double truth;
    Relation claimed;
  };
  fmt::print(
      "| claim | packings | nuclei of each | as claimed | against |\n|---|---|---|---|---|\n");
  for (const Planned& one : {Planned{"S7.top", 24, 0, Relation::higher},
                             {"S7.inner", 24, -0.21, Relation::same},
                             {"S7.stiff", 9, 0.05, Relation::same}}) {
    constexpr std::size_t packings = 16;
    const Kind kind = {one.id, margin_share, "", shares(one.nuclei), one.claimed, 1, 400};
    const Rates found = rates(kind, packings, one.truth, 0);
    fmt::print("| {} | {} | {} | {:.0f} % | {:.0f} % |\n", one.id, packings, one.nuclei,
               found.agrees, found.differs);
    const bool decided = std::max(found.agrees, found.differs) >= 80;
    EXPECT_EQ(decided, one.id == std::string_view("S7.top"));
  }
}

/// The published counts behind a claim of figure C: of each packing, by amplitude.
std::map<std::string, std::vector<GrowthBySize>> published_counts(const std::string& claim) {
  std::ifstream file(std::string(SHEARCELL_TEST_DATA) +
                     "/../../experiments/results/C/C.verdict.csv");
  std::map<std::string, std::map<std::string, GrowthBySize>> groups;
  std::vector<std::string> header;
  for (std::string line; std::getline(file, line);) {
    std::vector<std::string> cells;
    boost::split(cells, line, boost::is_any_of(","));
    if (header.empty()) header = cells;
    const auto cell = [&](const char* name) {
      return cells.at(static_cast<std::size_t>(std::ranges::find(header, name) - header.begin()));
    };
    if (cell("claim") != claim) continue;
    const auto number = [&](const char* name) { return std::stoul(cell(name)); };
    groups[cell("group")][cell("packing")][std::stoi(cell("size"))] = {
        number("grew"), number("absorbed"), number("shrank"), number("vanished")};
  }
  std::map<std::string, std::vector<GrowthBySize>> packings;
  for (const auto& [group, all] : groups) {
    for (const auto& [packing, counts] : all) packings[group].push_back(counts);
  }
  return packings;
}

/// The critical size from 10,000 runs, drawn from the packings with replacement. The bootstrap
/// takes groups of 100 runs as its units, which gives the same errors.
Estimate size_of_many(const std::vector<GrowthBySize>& packings, std::uint32_t campaign) {
  std::vector<GrowthBySize> groups(100);
  for (std::uint32_t k = 0; k < 10000; ++k) {
    const double u = uniform_pair({campaign, k, 0, 0}, 31)[0];
    const auto drawn = static_cast<std::size_t>(u * static_cast<double>(packings.size()));
    for (const auto& [size, count] : packings[drawn]) groups[k % 100][size] += count;
  }
  return GrowthCurve(groups).critical_size().value();
}

// If the truth is what the campaign found, 10,000 runs do not decide the claims either.
TEST(CannotBeDecided, TheClaimsOfFigureCWithTenThousandRuns) {
  std::size_t stated = 0;
  for (const PublishedAmplitude& one : published_amplitudes) {
    if (std::string_view(one.cannot_be_decided).empty()) continue;
    ++stated;
    const auto counts =
        published_counts(fmt::format("C: the critical size at A = {} rad is about {} grains",
                                     one.amplitude_rad, one.critical_size));
    ASSERT_EQ(counts.size(), 1U);
    const std::vector<GrowthBySize>& packings = counts.begin()->second;
    const auto [low, high] = GrowthCurve(packings).repeated_critical_size(8);
    std::uint32_t decided = 0;
    constexpr std::uint32_t campaigns = 10;
    Interval interval;
    for (std::uint32_t campaign = 0; campaign < campaigns; ++campaign) {
      const Estimate ours = size_of_many(packings, campaign);
      const double theirs = one.critical_size, size = ours.value;
      const Estimate published = {theirs, {theirs * size / high, theirs * size / low}};
      interval = relative_difference(ours, published)->interval;
      decided += ruling_of(interval, margin_critical_size, Relation::same) != Ruling::undecided;
    }
    fmt::print(
        "critical size at A = {}: {} of {} campaigns of 10,000 runs are decided; interval "
        "of the last {:.2f} to {:.2f}, margin {}\n",
        one.amplitude_rad, decided, campaigns, interval.low, interval.high, margin_critical_size);
    EXPECT_EQ(decided, 0U);
  }
  EXPECT_EQ(stated, 2U);
  // The ratio is 1: the same counts at both amplitudes.
  const auto counts = published_counts("C: the critical size grows with A");
  ASSERT_EQ(counts.size(), 2U);
  const std::vector<GrowthBySize>& packings = counts.rbegin()->second;
  std::uint32_t decided = 0;
  constexpr std::uint32_t campaigns = 40;
  for (std::uint32_t campaign = 0; campaign < campaigns; ++campaign) {
    const Interval interval = relative_difference(size_of_many(packings, 2 * campaign),
                                                  size_of_many(packings, 2 * campaign + 1))
                                  ->interval;
    decided += ruling_of(interval, 0, Relation::higher) != Ruling::undecided;
  }
  fmt::print(
      "growth, if the ratio is 1: {} of {} campaigns of 10,000 runs at each amplitude are "
      "decided\n",
      decided, campaigns);
  EXPECT_LE(decided, campaigns / 5);
}

}  // namespace
}  // namespace shearcell::test
