// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/cluster/queue_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace shearcell {
namespace {

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

QueuedRun task_of(const OpenSubmission& open, std::size_t task) {
  const Submission& submission = open.submission;
  QueuedRun found{.job = submission.job.empty() ? "" : fmt::format("{}_{}", submission.job, task),
                  .state = "ended",
                  .reason = {},
                  .node = {},
                  .reported = {}};
  for (const QueuedTask& queued : open.queue) {
    if (queued.name != submission.name() || queued.task != task) continue;
    found.job = fmt::format("{}_{}", queued.job, task);
    found.state = lower(queued.state);
    found.reason = queued.reason;
    found.node = queued.node;
  }
  return found;
}

}  // namespace

bool QueueView::busy() const {
  return std::any_of(submissions.begin(), submissions.end(),
                     [](const OpenSubmission& open) { return !open.queue.empty(); });
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
  return fmt::format("submission {}: job {}, {} of {} tasks{}{}", s.id, open.queue.front().job,
                     states.empty() ? "none" : states, s.tasks.size(), " in the queue",
                     folding ? fmt::format("; job {} will fold their stores", s.fold_job) : "");
}

}  // namespace shearcell
