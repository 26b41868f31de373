// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/cli/command.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/machine.hpp"
#include "provenance/io/read_number.hpp"

namespace shearcell::cli {

void add_json_option(CLI::App& command, Context& context) {
  command.add_flag("--json", context.json, "Print JSON for programs");
}

void add_common_options(CLI::App& command, Context& context) {
  command.add_option("--store", context.store, "Folder of the store; else $SHEARCELL_STORE")
      ->capture_default_str()
      ->type_name("DIR");
  add_json_option(command, context);
}

namespace {

CLI::Option* add_each(CLI::App& command, const char* name, auto& values, const char* help,
                      const char* type) {
  return command.add_option(name, values, help)->type_name(type)->allow_extra_args(false);
}

void add_variant_option(CLI::App& command, std::vector<std::string>& variants) {
  add_each(command, "--variant", variants,
           "Only runs with this swept value, as fluid=cell; several values of one key are "
           "alternatives, and those of other keys must fit too",
           "KEY=V");
}

template <class Enum>
CLI::IsMember is_name() {
  return CLI::IsMember(std::vector<std::string>(kNames<Enum>.begin(), kNames<Enum>.end()));
}

}  // namespace

void add_expand_options(CLI::App& command, ExpandOptions& options) {
  command.add_option("--scale", options.scale, "Named size (default: desk)");
  add_count(command, "--cycles", options.cycles, "Cycles instead of the manifest's");
  add_count(command, "--seeds", options.seeds, "Number of seeds instead of the manifest's", "N", 1,
            UINT64_MAX);
  add_variant_option(command, options.variants);
}

void add_selection_options(CLI::App& command, RunSelection& selection, bool states) {
  add_each(command, "--experiment", selection.experiments, "Only runs of this experiment", "NAME");
  add_each(command, "--scale", selection.scales, "Only runs of this scale", "NAME");
  add_variant_option(command, selection.variants);
  add_each(command, "--seed", selection.seeds, "Only runs with this seed", "N")
      ->check([](const std::string& text) { return unfit_count(text, 1, UINT64_MAX); });
  if (!states) return;
  add_each(command, "--state", selection.states, "Only runs in this state", "STATE")
      ->check(is_name<RunState>());
}

LoadedManifests load_manifests(const std::vector<std::string>& paths,
                               const ExpandOptions& options) {
  LoadedManifests loaded;
  for (const std::string& path : paths) {
    loaded.manifests.push_back(load_manifest(path));
    loaded.plans.push_back(expand(loaded.manifests.back(), options));
    for (const std::string& warning : loaded.plans.back().warnings) {
      tell_stderr("warning: {}\n", warning);
    }
  }
  return loaded;
}

MeasureOptions measure_options() {
  return {.workers = usable_cores(), .report = terminal_counter("measuring checkpoint")};
}

std::string unfit_count(const std::string& text, std::uint64_t low, std::uint64_t high) {
  const auto value = read_number<std::uint64_t>(text);
  const bool plain = value && (text[0] != '0' || text.size() == 1);
  if (plain && *value >= low && *value <= high) return "";
  if (high == UINT64_MAX) {
    return fmt::format("must be a whole number from {} on, in decimal digits (got '{}')", low,
                       text);
  }
  return fmt::format("must be a whole number from {} to {} in decimal digits (got '{}')", low, high,
                     text);
}

std::string unfit_number(const std::string& text, double low, double high) {
  const auto value = read_number<double>(text);
  if (value && *value >= low && *value <= high) return "";
  return fmt::format("must be a number from {} to {} in decimal digits (got '{}')", low, high,
                     text);
}

CLI::Option* add_number(CLI::App& command, const std::string& names, double& value,
                        const std::string& help, const std::string& type_name, double low,
                        double high) {
  const auto check = [low, high](const std::string& text) { return unfit_number(text, low, high); };
  return command.add_option(names, value, help)->check(check)->type_name(type_name);
}

void add_threads_option(CLI::App& command, std::size_t& threads, const std::string& help) {
  add_count(command, "--threads,-t", threads, help, "T", 1, 1024);
}

void add_engine_option(CLI::App& command, ExpandOptions& options) {
  command.add_option("--engine", options.engine, "What computes the shear (default: shearcell)")
      ->check(is_name<EngineKind>())
      ->type_name("NAME");
}

void print_json(const nlohmann::json& facts) {
  // Paths and hostnames may hold any byte; JSON may not. ASCII alone, since some characters beyond
  // it are commands to a terminal.
  fmt::print("{}\n", facts.dump(2, ' ', true, nlohmann::json::error_handler_t::replace));
}

std::string format_bytes(double bytes) {
  const char* unit = "B";
  for (const char* larger : {"kB", "MB", "GB", "TB"}) {
    if (bytes < 1000) break;
    bytes /= 1000;
    unit = larger;
  }
  return fmt::format("{:.3g} {}", bytes, unit);
}

}  // namespace shearcell::cli
