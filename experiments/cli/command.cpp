// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/cli/command.hpp"

#include <fmt/format.h>

#include <charconv>

namespace shearcell::cli {

void add_common_options(CLI::App& command, Context& context, bool with_json) {
  command.add_option("--store", context.store, "Folder of the store; else $SHEARCELL_STORE")
      ->capture_default_str()
      ->type_name("DIR");
  if (with_json) command.add_flag("--json", context.json, "Print JSON for programs");
}

void add_expand_options(CLI::App& command, ExpandOptions& options) {
  command.add_option("--scale", options.scale, "Named size (default: desk)");
  add_count(command, "--cycles", options.cycles, "Cycles instead of the manifest's");
  add_count(command, "--seeds", options.seeds, "Number of seeds instead of the manifest's");
}

std::string unfit_count(const std::string& text, std::uint64_t low, std::uint64_t high) {
  std::uint64_t value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  const bool plain = error == std::errc() && stop == end && (text[0] != '0' || text.size() == 1);
  if (plain && value >= low && value <= high) return "";
  if (high == UINT64_MAX) {
    return fmt::format("'{}' is not a whole number >= {} in decimal digits", text, low);
  }
  return fmt::format("'{}' is not a whole number from {} to {} in decimal digits", text, low, high);
}

void add_threads_option(CLI::App& command, std::size_t& threads, const std::string& help) {
  add_count(command, "--threads,-t", threads, help, "T", 1, 1024);
}

void add_engine_option(CLI::App& command, ExpandOptions& options) {
  command.add_option("--engine", options.engine, "What computes the shear (default: shearcell)")
      ->check(CLI::IsMember(
          std::vector<std::string>(kNameList<EngineKind>.begin(), kNameList<EngineKind>.end())))
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
