// SPDX-License-Identifier: GPL-3.0-or-later
// `bench stability`: hard cases and their outcomes.
#include <fmt/format.h>

#include <memory>

#include "experiments/bench/stability/stability.hpp"
#include "experiments/cli/command.hpp"

namespace shearcell::cli {
namespace {

void print_case(const StabilityResult& r) {
  fmt::print("{} {}  ({:.1f} s)\n    {}\n    expected: {}\n    outcome:  {}\n",
             r.as_expected ? "ok " : "NOT", r.name, r.seconds, r.done, r.expected, r.outcome);
}

void stability(const StabilityOptions& options, Context& context) {
  const std::vector<StabilityResult> results = map_stability(options);
  nlohmann::json cases = nlohmann::json::array();
  std::size_t right = 0;
  double seconds = 0;
  for (const StabilityResult& r : results) {
    right += r.as_expected ? 1 : 0;
    seconds += r.seconds;
    if (!context.json) print_case(r);
    cases.push_back({{"name", r.name},
                     {"done", r.done},
                     {"expected", r.expected},
                     {"outcome", r.outcome},
                     {"as_expected", r.as_expected},
                     {"seconds", r.seconds}});
  }
  if (context.json) {
    print_json({{"cases", cases}});
  } else {
    fmt::print("{} of {} cases ended as expected, in {:.0f} s.\n", right, results.size(), seconds);
  }
  if (right < results.size()) context.exit_code = kRunFailed;
}

}  // namespace

void add_bench_stability(CLI::App& bench, Context& context) {
  auto options = std::make_shared<StabilityOptions>();
  CLI::App* command = bench.add_subcommand(
      "stability", "Run hard cases: each must give the right answer or be stopped with the reason");
  command->add_option("--only", options->only, "Names of cases, or their beginnings")
      ->type_name("NAME")
      ->check(unknown_case, "");
  command->add_flag("--quick", options->quick, "Fewer steps in the very long cases");
  add_number(*command, "--seconds", options->seconds_per_case,
             "A case that takes longer counts as hanging", "S", 0.1, 86400);
  command->add_flag("--json", context.json, "Print JSON for programs");
  command->footer(
      "Ends with code 3 if a case does not end as expected.\n"
      "Examples:\n  shearcell bench stability --quick\n"
      "  shearcell bench stability --only vacancy limit --json");
  command->callback([options, &context] {
    options->report = [](const std::string& what) { tell_stderr("{}\n", what); };
    stability(*options, context);
  });
}

}  // namespace shearcell::cli
