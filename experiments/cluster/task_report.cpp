// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/cluster/task_report.hpp"

#include <nlohmann/json.hpp>
#include <system_error>

#include "provenance/io/plain_file.hpp"
#include "provenance/json_text.hpp"
#include "provenance/limits.hpp"

namespace shearcell {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

fs::path report_file(fs::path folder) {
  return folder += ".progress.json";
}

}  // namespace

void write_task_report(const fs::path& folder, const std::vector<RunRecord>& runs) {
  json list = json::array();
  for (const RunRecord& run : runs) {
    list.push_back({{"id", run.id}, {"state", name_of(run.state)}, {"cycle", run.cycle}});
  }
  try {
    write_output(report_file(folder), json{{"runs", list}}.dump() + "\n");
  } catch (const std::system_error&) {
    // It only informs, and is written again soon.
  }
}

std::map<std::string, ReportedRun> read_task_report(const fs::path& folder) {
  std::map<std::string, ReportedRun> reported;
  const json facts =
      parse_json(read_plain(report_file(folder), StoreLimits::value_bytes).value_or(""));
  try {
    for (const json& run : facts.at("runs")) {
      const auto state = value_of<RunState>(run.at("state").get_ref<const std::string&>());
      if (!state) continue;
      reported[run.at("id").get<std::string>()] = {*state, run.at("cycle").get<double>()};
    }
  } catch (const json::exception&) {
    reported.clear();  // it only informs
  }
  return reported;
}

}  // namespace shearcell
