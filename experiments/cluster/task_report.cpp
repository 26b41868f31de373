// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/cluster/task_report.hpp"

#include <fstream>
#include <nlohmann/json.hpp>

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
  const fs::path file = report_file(folder);
  fs::path beside = file;
  beside += ".new";
  std::ofstream out(beside, std::ios::trunc);
  out << json{{"runs", list}}.dump() << "\n";
  out.close();
  if (out) fs::rename(beside, file);
}

std::map<std::string, ReportedRun> read_task_report(const fs::path& folder) {
  std::map<std::string, ReportedRun> reported;
  std::ifstream in(report_file(folder));
  const json facts = json::parse(in, nullptr, false);
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
