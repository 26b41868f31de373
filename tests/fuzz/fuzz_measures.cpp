// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/crystal.hpp"
#include "analysis/derived_measures.hpp"
#include "analysis/error.hpp"
#include "tests/fuzz/seeds.hpp"
#include "tests/fuzz/targets.hpp"

namespace shearcell::fuzz {
namespace {

void run(Input input) {
  const auto attempt = [](auto&& read) {
    try {
      read();
    } catch (const AnalysisError&) {
    }
  };
  attempt([&] {
    const nlohmann::json result = decode_result(std::as_bytes(input));
    attempt([&] { read_measures(result); });
    attempt([&] { read_crystallite_map(result); });
  });
}

}  // namespace

const Target measures_target{"measures", run, measure_seeds};

}  // namespace shearcell::fuzz
