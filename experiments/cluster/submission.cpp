// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/cluster/submission.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <random>
#include <system_error>

#include "experiments/manifest/suggest.hpp"
#include "experiments/runner/asks.hpp"
#include "experiments/runner/audit.hpp"
#include "provenance/errors.hpp"
#include "provenance/io/child_process.hpp"
#include "provenance/io/file.hpp"
#include "provenance/json_text.hpp"
#include "provenance/limits.hpp"

namespace shearcell {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t kIdDigits = 12;

std::string fresh_id() {
  std::random_device random;
  return fmt::format("{:08x}{:08x}", random(), random()).substr(0, kIdDigits);
}

bool is_id(const std::string& text) {
  return text.size() == kIdDigits &&
         text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

void apply(std::vector<Submission>& known, const Event& event) {
  const json body = event.body();
  const std::string id = body.at("submission");
  if (!is_id(id)) throw StoreDamaged(fmt::format("'{}' is not the id of a submission", id));
  if (event.type == "CampaignSubmitted") {
    Submission& made = known.emplace_back();
    made.id = id;
    for (const json& task : body.at("tasks")) made.tasks.push_back(task.at("runs"));
  } else if (event.type == "JobQueued") {
    for (Submission& submission : known) {
      if (submission.id != id) continue;
      submission.job = body.at("job");
      submission.merge_job = body.at("fold_job");
    }
  }
}

fs::path report_file(fs::path folder) {
  return folder += ".progress.json";
}

QueuedTask task_of(const Submission& submission, std::size_t task) {
  QueuedTask found{submission.name(), submission.job, task, "ended", "", ""};
  for (const QueuedTask& queued : submission.queue) {
    if (queued.name == submission.name() && queued.task == task) found = queued;
  }
  if (!found.job.empty()) found.job += fmt::format("_{}", task);
  found.state = lower(found.state);
  return found;
}

}  // namespace

std::vector<Submission> read_submissions(const Store& store) {
  std::vector<Submission> known;
  for (const Event& event : store.events(kSubmissions)) {
    try {
      apply(known, event);
    } catch (const json::exception& problem) {
      throw damaged_payload(event, problem);
    }
  }
  return known;
}

std::vector<Submission> unfinished_submissions(const Store& store) {
  std::vector<Submission> open = read_submissions(store);
  // Submissions without a folder were merged from other stores.
  std::erase_if(open, [&](const Submission& s) { return !fs::exists(s.folder(store.folder())); });
  if (open.empty()) return open;
  std::map<std::string, RunRecord> runs;
  for (RunRecord& run : store.runs()) runs.emplace(run.id, std::move(run));
  std::map<std::string, bool> done;  // by run; has_work_left() reads the log
  const auto is_done = [&](const std::string& id) {
    const auto [known, fresh] = done.try_emplace(id, false);
    const auto run = fresh ? runs.find(id) : runs.end();
    if (run != runs.end()) known->second = !has_work_left(store, run->second);
    return known->second;
  };
  std::erase_if(open, [&](const Submission& submission) {
    return std::ranges::all_of(
        submission.tasks, [&](const auto& task) { return std::ranges::all_of(task, is_done); });
  });
  return open;
}

void ask_queue(std::vector<Submission>& submissions) {
  std::vector<std::string> names;
  for (const Submission& s : submissions) {
    names.push_back(s.name());
    names.push_back(s.merge_name());
  }
  for (QueuedTask& task : ask_queue(names)) {
    for (Submission& s : submissions) {
      if (task.name != s.name() && task.name != s.merge_name()) continue;
      s.queue.push_back(std::move(task));
      break;
    }
  }
}

std::vector<MergeReport> merge_tasks(Store& store, const Submission& submission) {
  std::vector<MergeReport> reports;
  for (std::size_t task = 1; task <= submission.tasks.size(); ++task) {
    const fs::path folder = submission.task_store(store.folder(), task);
    if (!fs::exists(folder / "store.sqlite")) continue;
    for (MergeReport& report : merge_stores(store, {folder})) reports.push_back(std::move(report));
  }
  return reports;
}

std::set<std::string> busy_runs(const Store& store, const std::vector<Submission>& open) {
  std::set<std::string> busy;
  for (const Submission& submission : open) {
    if (submission.queue.empty()) continue;
    for (const auto& task : submission.tasks) busy.insert(task.begin(), task.end());
  }
  for (const Lease& lease : store.leases()) busy.insert(lease.run);
  // Also their packings that are not settled yet.
  const std::vector<RunRecord> runs = store.runs();
  std::set<std::string> parents;
  for (const RunRecord& run : runs) {
    if (busy.contains(run.id)) parents.insert(run.parent);
  }
  for (const RunRecord& run : runs) {
    if (parents.contains(run.id) && run.state != RunState::completed) busy.insert(run.id);
  }
  return busy;
}

Submission prepare_submission(Store& store, const std::vector<Share>& shares, json facts,
                              std::size_t seen) {
  Submission made;
  made.id = fresh_id();
  facts["submission"] = made.id;
  facts["tasks"] = json::array();
  for (const Share& share : shares) {
    made.tasks.push_back(share.runs);
    facts["tasks"].push_back({{"runs", share.runs}});
  }
  try {
    for (std::size_t task = 1; task <= shares.size(); ++task) {
      const std::vector<std::string>& runs = made.tasks[task - 1];
      std::set<std::string> stages(runs.begin(), runs.end());
      for (const std::string& run : runs) stages.insert(store.run(run).parent);  // the packings
      Store own(made.task_store(store.folder(), task), Access::create);
      merge_stores(own, {store.folder()}, stages);
    }
    store.record_submission("CampaignSubmitted", facts, seen);
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(made.folder(store.folder()), ignored);
    throw;
  }
  return made;
}

void write_task_report(const fs::path& folder, const std::vector<RunRecord>& runs) {
  json list = json::array();
  for (const RunRecord& run : runs) {
    list.push_back({{"id", run.id}, {"state", name_of(run.state)}, {"cycle", run.cycle}});
  }
  try {
    write_output(report_file(folder), json{{"runs", list}}.dump() + "\n");
  } catch (const std::system_error&) {
    // It is for information only, and written again soon.
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
    reported.clear();  // it is for information only
  }
  return reported;
}

bool QueueView::busy() const {
  return std::ranges::any_of(submissions, [](const auto& open) { return !open.queue.empty(); });
}

QueueView view_queue(const Store& store) {
  QueueView view;
  view.submissions = unfinished_submissions(store);
  try {
    ask_queue(view.submissions);
  } catch (const ProgramError& error) {
    view.problem = error.what();
  }
  std::map<std::string, std::string> packing_of;
  for (const RunRecord& run : store.runs()) packing_of[run.id] = run.parent;
  for (const Submission& open : view.submissions) {
    for (std::size_t task = 1; task <= open.tasks.size(); ++task) {
      const auto reports = read_task_report(open.task_store(store.folder(), task));
      const QueuedTask queued = task_of(open, task);
      std::vector<std::string> ids = open.tasks[task - 1];
      for (const std::string& run : open.tasks[task - 1]) ids.push_back(packing_of[run]);
      for (const std::string& id : ids) {
        QueuedRun& run = view.runs[id] = {queued, {}};  // of the newest submission that has it
        const auto reported = reports.find(id);
        if (reported != reports.end()) run.reported = reported->second;
      }
    }
  }
  return view;
}

std::string describe(const Submission& s) {
  if (s.queue.empty()) {
    return fmt::format(
        "submission {}: its jobs have ended with runs unfinished; `submit` them again", s.id);
  }
  std::map<std::string, std::size_t> count;
  std::string merge_job;
  for (const QueuedTask& task : s.queue) {
    if (task.name == s.name()) ++count[lower(task.state)];
    if (task.name == s.merge_name()) merge_job = task.job;
  }
  std::string states;
  for (const auto& [state, tasks] : count) {
    states += fmt::format("{}{} {}", states.empty() ? "" : ", ", tasks, state);
  }
  return fmt::format(
      "submission {}: job {}, {} of {} tasks in the queue{}", s.id,
      s.job.empty() ? s.queue.front().job : s.job, states.empty() ? "none" : states, s.tasks.size(),
      merge_job.empty() ? "" : fmt::format("; job {} will merge their stores", merge_job));
}

}  // namespace shearcell
