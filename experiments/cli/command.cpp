// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/cli/command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

namespace shearcell::cli {

void add_common_options(CLI::App& command, Context& context, bool with_json) {
  command.add_option("--store", context.store, "Folder of the store; else $SHEARCELL_STORE")
      ->capture_default_str()
      ->type_name("DIR");
  if (with_json) command.add_flag("--json", context.json, "Print JSON for programs");
}

void print_json(const nlohmann::json& facts) {
  // Paths and hostnames may hold any byte; JSON may not.
  fmt::print("{}\n", facts.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

void print_table(const std::vector<std::string>& header,
                 const std::vector<std::vector<std::string>>& rows) {
  const auto is_number = [](const std::string& cell) {
    return cell.empty() || cell.find_first_not_of("0123456789.-+e:%") == std::string::npos;
  };
  std::vector<std::size_t> width(header.size());
  std::vector<bool> right(header.size(), true);
  for (std::size_t c = 0; c < header.size(); ++c) {
    width[c] = header[c].size();
    for (const auto& row : rows) {
      width[c] = std::max(width[c], row[c].size());
      right[c] = right[c] && is_number(row[c]);
    }
  }
  const auto print_row = [&](const std::vector<std::string>& row) {
    std::string line;
    for (std::size_t c = 0; c < row.size(); ++c) {
      if (c > 0) line += "  ";
      line += right[c] ? fmt::format("{:>{}}", row[c], width[c])
                       : fmt::format("{:<{}}", row[c], width[c]);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    fmt::print("{}\n", line);
  };
  print_row(header);
  for (const auto& row : rows) print_row(row);
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
