// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/cluster/submission.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <random>

#include "experiments/runner/audit.hpp"
#include "provenance/errors.hpp"

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
      submission.fold_job = body.at("fold_job");
    }
  }
}

bool all_completed(const Submission& submission, const std::set<std::string>& completed) {
  return std::ranges::all_of(submission.tasks, [&](const auto& task) {
    return std::ranges::all_of(task, [&](const auto& run) { return completed.contains(run); });
  });
}

}  // namespace

std::vector<Submission> read_submissions(const Store& store) {
  std::vector<Submission> known;
  for (const Event& event : store.events(kSubmissions)) {
    try {
      apply(known, event);
    } catch (const json::exception& problem) {
      throw StoreDamaged(fmt::format("{}: event {} ({}): its payload is not as it must be: {}",
                                     store.folder().string(), event.seq, event.type,
                                     problem.what()));
    }
  }
  return known;
}

std::vector<OpenSubmission> unfinished_submissions(const Store& store) {
  std::vector<OpenSubmission> open;
  std::set<std::string> completed;
  for (const RunRecord& run : store.runs()) {
    if (run.state == RunState::completed) completed.insert(run.id);
  }
  for (Submission& submission : read_submissions(store)) {
    // Others came by `merge` from stores elsewhere.
    if (!fs::exists(submission.folder(store.folder()))) continue;
    if (all_completed(submission, completed)) continue;
    open.push_back({std::move(submission), {}});
  }
  return open;
}

void ask_queue(std::vector<OpenSubmission>& submissions) {
  std::vector<std::string> names;
  for (const OpenSubmission& open : submissions) {
    names.push_back(open.submission.name());
    names.push_back(open.submission.fold_name());
  }
  for (QueuedTask& task : ask_queue(names)) {
    for (OpenSubmission& open : submissions) {
      const Submission& s = open.submission;
      if (task.name != s.name() && task.name != s.fold_name()) continue;
      open.queue.push_back(std::move(task));
      break;
    }
  }
}

std::vector<MergeReport> fold(Store& store, const Submission& submission) {
  std::vector<MergeReport> reports;
  for (std::size_t task = 1; task <= submission.tasks.size(); ++task) {
    const fs::path folder = submission.task_store(store.folder(), task);
    if (!fs::exists(folder / "store.sqlite")) continue;
    for (MergeReport& report : merge_stores(store, {folder})) reports.push_back(std::move(report));
  }
  return reports;
}

std::set<std::string> busy_runs(const Store& store, const std::vector<OpenSubmission>& open) {
  std::set<std::string> busy;
  for (const OpenSubmission& submission : open) {
    if (submission.queue.empty()) continue;
    for (const auto& task : submission.submission.tasks) busy.insert(task.begin(), task.end());
  }
  for (const Lease& lease : store.leases()) busy.insert(lease.run);
  // Their packings as well, while these are still to be settled.
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
      Store own(made.task_store(store.folder(), task), Access::create);
      merge_stores(own, {store.folder()}, shares[task - 1].stages);
    }
    store.record_submission("CampaignSubmitted", facts, seen);
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(made.folder(store.folder()), ignored);
    throw;
  }
  return made;
}

}  // namespace shearcell
