// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/cluster/task_report.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <nlohmann/json.hpp>

namespace shearcell {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::array<RunState, 5> kStates = {RunState::declared, RunState::running,
                                             RunState::interrupted, RunState::failed,
                                             RunState::completed};

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
      const std::string name = run.at("state");
      const auto state = std::find_if(kStates.begin(), kStates.end(),
                                      [&name](RunState known) { return name == name_of(known); });
      if (state == kStates.end()) continue;
      reported[run.at("id").get<std::string>()] = {*state, run.at("cycle").get<double>()};
    }
  } catch (const json::exception&) {
    reported.clear();  // it only informs
  }
  return reported;
}

}  // namespace shearcell
