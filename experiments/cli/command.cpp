// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/cli/command.hpp"

#include <fmt/format.h>

namespace shearcell::cli {

void add_common_options(CLI::App& command, Context& context, bool with_json) {
  command.add_option("--store", context.store, "Folder of the store; else $SHEARCELL_STORE")
      ->capture_default_str()
      ->type_name("DIR");
  if (with_json) command.add_flag("--json", context.json, "Print JSON for programs");
}

void add_expand_options(CLI::App& command, ExpandOptions& options) {
  command.add_option("--scale", options.scale, "Named size (default: desk)");
  command.add_option("--cycles", options.cycles, "Cycles instead of the manifest's");
  command.add_option("--seeds", options.seeds, "Number of seeds instead of the manifest's");
}

void add_engine_option(CLI::App& command, ExpandOptions& options) {
  command.add_option("--engine", options.engine, "What computes the shear (default: shearcell)")
      ->check(CLI::IsMember({"shearcell", "lammps"}))
      ->type_name("NAME");
}

void print_json(const nlohmann::json& facts) {
  // Paths and hostnames may hold any byte; JSON may not.
  fmt::print("{}\n", facts.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
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
