// SPDX-License-Identifier: GPL-3.0-or-later
// `new`: writes a commented manifest with every key of the schema.
#include <fmt/format.h>

#include <filesystem>
#include <sstream>

#include "experiments/cli/command.hpp"
#include "experiments/manifest/manifest.hpp"
#include "experiments/manifest/schema.hpp"
#include "provenance/errors.hpp"
#include "provenance/io/child_process.hpp"
#include "provenance/io/file.hpp"
#include "provenance/json_text.hpp"

namespace shearcell::cli {
namespace {

/// Returns comment lines: the meaning of the key, and below it the key with its default value.
std::string entry(const Field& field) {
  std::string about(field.doc);
  if (!field.symbol.empty()) about += fmt::format("; {} in the supplement", field.symbol);
  about += fmt::format("; {}", expected_values(field));
  std::istringstream lines(filled(about, 86));
  std::string text;
  for (std::string line; std::getline(lines, line);) text += "  # " + line + "\n";
  return text + fmt::format("  # {}: {}\n", field.name, value_text(field.get({})));
}

std::string text_of(const std::string& experiment) {
  std::string text = fmt::format(
      R"(# Keys that are commented out are shown with their default values.
# `shearcell plan FILE --scale smoke` checks this file and lists its runs.
experiment: {}
question: What is to be found out?
# `shearcell figures --help` lists the figures and the keys that they compare.
figures: [S2]
# Your own plots and claims (see `shearcell manual`):
# plots:
#   - {{name: compaction, y: phi, x: cycle, show: traces}}
# claims:
#   - {{id: same, compare: phi, at_cycle: 10, between: [{{fluid: still}}, {{fluid: cell}}], margin: 0.001}}
# labels: {{"fluid=still": "fluid at rest"}}

base:
  grains: {}
  amplitude_rad: {}

)",
      experiment, Parameters{}.grains, Parameters{}.amplitude_rad);
  for (const Field& field : schema()) {
    if (field.name != "grains" && field.name != "amplitude_rad") text += entry(field);
  }
  return text +
         R"(
# Parameters that have a different value while the packing settles:
# settle: {drag_kg_per_s: 1.28e-3}
# Start from the recorded state of a run instead of a settled packing:
# start: {experiment: drag, variant: "fluid=still", seed: 3, cycle: 10, noise_d: 1.0e-13}

# Parameters to vary: all combinations of the keys in `grid`; the keys in `zip` change together.
sweep:
  grid:
    fluid: [still, cell]
  # zip: {moving_wall: [bottom, top], pressure_at: [top, moving_wall]}

seeds: 6                       # 1 to 6, or a list

checkpoints:
  every_cycles: 1
  # phases: [0.25, 0.5, 0.75]    # more checkpoints within each cycle
# until: {crystalline_percent: 10, extra_cycles: 15}    # ends runs before their last cycle

# Scales are named sizes. Values in a scale replace the values above.
scales:
  smoke: {grains: 600, seeds: 2, cycles: 5}
  desk: {grains: 5200, seeds: 3, cycles: 120}
  paper: {cycles: 200}
)";
}

void make(const std::string& name, Context&) {
  std::filesystem::path file = name;
  const bool whole = file.extension() == ".yaml" || file.extension() == ".yml";
  const std::string experiment = (whole ? file.stem() : file.filename()).string();
  if (!whole) file += ".yaml";
  if (!is_name(experiment)) {
    throw UsageError(
        fmt::format("'{}' is not a valid name of an experiment. A name has 1 to {} letters, "
                    "digits, - and _, and does not begin with -.",
                    experiment, kLongestName));
  }
  const std::string text = text_of(experiment);
  parse_manifest(text, file.string());  // throws if text_of() is not a valid manifest
  if (exists(symlink_status(file))) {
    throw UsageError(file.string() +
                     ": the file already exists. Choose another name, or remove the file.");
  }
  write_output(file, text);
  print_text("{}: written. Next: shearcell plan {} --scale smoke\n", file.string(),
             shell_word(file.string()));
}

}  // namespace

void add_new(CLI::App& app, Context& context) {
  const auto [command, name] = add_command(app, context, "new", "Write a commented manifest", make);
  command->add_option("name", *name, "Name of the experiment, or path of the file")->required();
  command->footer(
      R"(Writes every parameter with its meaning and default, a sweep of `fluid`, and three scales.
Does not overwrite a file.
Examples:
  shearcell new softer
  shearcell new studies/softer.yaml)");
}

}  // namespace shearcell::cli
