// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/cluster/queue_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
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

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

QueuedRun task_of(const OpenSubmission& open, std::size_t task) {
  const Submission& submission = open.submission;
  QueuedRun found;
  if (!submission.job.empty()) found.job = fmt::format("{}_{}", submission.job, task);
  found.state = "ended";
  for (const QueuedTask& queued : open.queue) {
    if (queued.name != submission.name() || queued.task != task) continue;
    found = {fmt::format("{}_{}", queued.job, task),
             lower(queued.state),
             queued.reason,
             queued.node,
             {}};
  }
  return found;
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

bool QueueView::busy() const {
  return std::ranges::any_of(submissions, [](const auto& open) { return !open.queue.empty(); });
}

QueueView look_at_queue(const Store& store) {
  QueueView view;
  view.submissions = unfinished_submissions(store);
  try {
    ask_queue(view.submissions);
  } catch (const ClusterError& error) {
    view.problem = error.what();
  }
  std::map<std::string, std::string> packing_of;
  for (const RunRecord& run : store.runs()) packing_of[run.id] = run.parent;
  for (const OpenSubmission& open : view.submissions) {
    for (std::size_t task = 1; task <= open.submission.tasks.size(); ++task) {
      const auto reports = read_task_report(open.submission.task_store(store.folder(), task));
      const QueuedRun queued = task_of(open, task);
      std::vector<std::string> ids = open.submission.tasks[task - 1];
      for (const std::string& run : open.submission.tasks[task - 1]) ids.push_back(packing_of[run]);
      for (const std::string& id : ids) {
        QueuedRun& run = view.runs[id] = queued;  // of the newest submission that has it
        const auto reported = reports.find(id);
        if (reported != reports.end()) run.reported = reported->second;
      }
    }
  }
  return view;
}

std::string describe(const OpenSubmission& open) {
  const Submission& s = open.submission;
  if (open.queue.empty()) {
    return fmt::format(
        "submission {}: its jobs have ended with runs unfinished; `submit` them again", s.id);
  }
  std::map<std::string, std::size_t> count;
  bool folding = false;
  for (const QueuedTask& task : open.queue) {
    if (task.name == s.name()) ++count[lower(task.state)];
    folding = folding || task.name == s.fold_name();
  }
  std::string states;
  for (const auto& [state, tasks] : count) {
    states += fmt::format("{}{} {}", states.empty() ? "" : ", ", tasks, state);
  }
  return fmt::format("submission {}: job {}, {} of {} tasks in the queue{}", s.id,
                     open.queue.front().job, states.empty() ? "none" : states, s.tasks.size(),
                     folding ? fmt::format("; job {} will fold their stores", s.fold_job) : "");
}

}  // namespace shearcell
