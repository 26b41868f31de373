// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/cluster/submission.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <boost/algorithm/string/replace.hpp>
#include <functional>
#include <random>
#include <system_error>
#include <utility>

#include "experiments/manifest/suggest.hpp"
#include "experiments/runner/audit.hpp"
#include "experiments/runner/outlook.hpp"
#include "provenance/errors.hpp"
#include "provenance/io/child_process.hpp"
#include "provenance/io/file.hpp"
#include "provenance/json_text.hpp"
#include "provenance/limits.hpp"

namespace shearcell {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t kMostCpus = 16;
constexpr std::size_t kIdDigits = 12;

// job.sh PROGRAM FOLDER ARGUMENT...
//
// Before the time limit, Slurm sends USR1 only to this script (`B:` in --signal). To cancel or
// preempt a job, Slurm sends TERM to all processes. The script passes both signals on to the
// program, which then records its states and ends with code 85. After USR1, the script also queues
// the task again. It identifies the task as ARRAY_TASK ("17_3"), because the job number of a task
// may also be the number of the whole array. If the program is killed, for example for lack of
// memory, the script starts it again.
constexpr const char* kTaskScript = R"sh(#!/bin/bash
again= stopped= signalled= program= leave=${SLURM_RESTART_COUNT:+--leave-failed}
pass_on() {
  signalled=$1
  [ -n "$program" ] || return 0
  # Sent several times: a program that is just starting is a copy of this shell and ignores it.
  for pause in 1 2 4; do kill -"$1" "$program" 2>/dev/null || break; sleep "$pause"; done
}
trap 'again=yes; pass_on USR1' USR1
trap 'again= stopped=yes; pass_on TERM' TERM
for start in 1 2 3 4; do
  program=
  "$1" resume --task --store "$2/task-$SLURM_ARRAY_TASK_ID" "${@:3}" $leave &
  program=$!
  [ -z "$signalled" ] || pass_on "$signalled"  # the signal came before the number was known
  wait "$program"; code=$?
  while [ -n "$signalled" ]; do signalled=; wait "$program"; code=$?; done
  [ "$code" -gt 128 ] && [ -z "$again$stopped" ] || break
  echo "Attempt $start: the program was killed (code $code)."
  leave=--leave-failed
done
if [ -n "$again" ] && [ "$code" -ge 85 ]; then
  echo "The time limit is near; the task is queued again."
  env -u SLURM_CLUSTERS scontrol requeue "${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID"
fi
exit "$code"
)sh";

// fold.sh PROGRAM FOLDER TASKS STORE
constexpr const char* kMergeScript = R"sh(#!/bin/bash
code=0
for ((task = 1; task <= $3; ++task)); do
  "$1" merge "$2/task-$task" --store "$4" || code=$?
done
exit "$code"
)sh";

/// Adds the command to the job. sbatch uses the last of repeated options. The user's options come
/// after --export and before all other options, so the user can replace only --export.
/// Environment variables cannot replace an option: for sbatch, options take precedence.
Job complete(Job job, const JobOptions& options, const fs::path& folder, const std::string& log,
             const std::vector<std::string>& own, const std::vector<std::string>& arguments) {
  std::vector<std::string>& words = job.command;
  const auto append = [&](const auto& more) {
    words.insert(words.end(), more.begin(), more.end());
  };
  words = {"sbatch", "--parsable", "--export=ALL"};
  append(options.sbatch);
  append(std::vector<std::string>{
      "--nodes=1", "--ntasks=1", "--requeue", "--open-mode=append", "--job-name=" + job.name,
      "--output=" + boost::replace_all_copy(folder.string(), "%", "%%") + "/" + log});  // %a works
  append(own);
  append(std::vector<std::string>{job.file, fs::read_symlink("/proc/self/exe"), folder});
  append(arguments);
  return job;
}

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

std::vector<Share> shares_of(const std::vector<Plan>& plans, const Store* store) {
  const Rates rates(store == nullptr ? std::vector<Stage>{} : store->stages());
  std::vector<Share> shares;
  std::map<std::string, std::size_t> places;  // stage -> index of its packing in `shares`
  for (const PlannedStage& one : look_at(plans, store)) {
    const std::string &id = one.stage.id, &parent = one.stage.parent;
    const auto [place, fresh] = places.try_emplace(parent.empty() ? id : parent, shares.size());
    if (fresh) shares.emplace_back().packings = {place->first};
    places.emplace(id, place->second);
    if (!parent.empty() && one.look.done) continue;
    Share& share = shares[place->second];
    if (!parent.empty()) share.runs.push_back(id);
    share.particle_steps += one.look.particle_steps;
    share.core_seconds += one.look.particle_steps / rates.of(one.stage).particle_steps_per_second;
  }
  std::erase_if(shares, [](const Share& share) { return share.runs.empty(); });
  return shares;
}

std::vector<Share> share_out(std::vector<Share> packings, std::size_t tasks) {
  std::ranges::stable_sort(packings, std::greater(), &Share::core_seconds);
  std::vector<Share> shares(std::min(tasks, packings.size()));
  for (const Share& packing : packings) {
    // At equal core time, the share with fewer packings gets `packing`. So no share stays empty.
    const auto load = [](const Share& share) {
      return std::pair(share.core_seconds, share.packings.size());
    };
    Share& least = *std::ranges::min_element(shares, std::less(), load);
    std::ranges::copy(packing.packings, std::back_inserter(least.packings));
    std::ranges::copy(packing.runs, std::back_inserter(least.runs));
    least.particle_steps += packing.particle_steps;
    least.core_seconds += packing.core_seconds;
  }
  return shares;
}

Proposal propose(const std::vector<Plan>& plans, const Store* store,
                 const std::set<std::string>& busy, std::size_t most_tasks, JobOptions job) {
  Proposal made;
  std::vector<Share> packings = shares_of(plans, store);
  std::erase_if(packings, [&](const Share& packing) {
    const auto is_busy = [&](const std::string& id) { return busy.contains(id); };
    const bool taken = std::ranges::any_of(packing.packings, is_busy) ||
                       std::ranges::any_of(packing.runs, is_busy);
    if (taken) made.left_out += packing.runs.size();
    return taken;
  });
  made.shares = share_out(std::move(packings), most_tasks);
  if (job.cpus == 0) {
    std::size_t most = 1;
    for (const Share& share : made.shares) most = std::max(most, share.runs.size());
    job.cpus = std::max(std::min(kMostCpus, most * job.threads), job.threads);
  }
  made.job = std::move(job);
  return made;
}

double Proposal::seconds(const Share& share) const {
  const std::size_t busy = std::min(job.cpus, share.runs.size() * job.threads);
  return share.core_seconds / static_cast<double>(busy);
}

Job array_job(const Submission& submission, const fs::path& store, const JobOptions& options) {
  const std::size_t jobs = std::max<std::size_t>(1, options.cpus / options.threads);
  std::vector<std::string> arguments = {"--jobs", fmt::to_string(jobs), "--threads",
                                        fmt::to_string(options.threads)};
  // On the node, `resume --task` replaces the variables in the path.
  if (!options.scratch.empty()) arguments.push_back("--scratch=" + options.scratch);
  return complete({submission.name(), "job.sh", kTaskScript, {}}, options, submission.folder(store),
                  "task-%a.log",
                  {fmt::format("--array=1-{}", submission.tasks.size()),
                   fmt::format("--cpus-per-task={}", options.cpus),
                   fmt::format("--signal=B:USR1@{}", options.warn_seconds)},
                  arguments);
}

Job merge_job(const Submission& submission, const fs::path& store, const JobOptions& options,
              const std::string& array) {
  return complete({submission.merge_name(), "fold.sh", kMergeScript, {}}, options,
                  submission.folder(store), "fold.log", {"--dependency=afterany:" + array},
                  {fmt::to_string(submission.tasks.size()), store});
}

Submission prepare_submission(Store& store, const Proposal& proposal, json facts,
                              std::size_t seen) {
  Submission made;
  made.id = fresh_id();
  facts["submission"] = made.id;
  facts["tasks"] = json::array();
  try {
    for (const Share& share : proposal.shares) {
      made.tasks.push_back(share.runs);
      facts["tasks"].push_back({{"runs", share.runs}});
      Store own(made.task_store(store.folder(), made.tasks.size()), Access::create);
      merge_stores(own, {store.folder()}, with_parents(store, share.runs));
    }
    facts["command"] = array_job(made, store.folder(), proposal.job).command;
    store.record(kSubmissions, {"CampaignSubmitted", facts}, seen);
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(made.folder(store.folder()), ignored);
    throw;
  }
  return made;
}

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
  const auto is_done = [&](const std::string& id) { return look_at(store, store.stage(id)).done; };
  std::erase_if(open, [&](const Submission& submission) {
    // A submission without a folder was copied here when another store was merged.
    return !fs::exists(submission.folder(store.folder())) ||
           std::ranges::all_of(submission.tasks, [&](const auto& task) {
             return std::ranges::all_of(task, is_done);
           });
  });
  return open;
}

std::uint64_t merge_tasks(Store& store, const Submission& submission) {
  std::uint64_t checkpoints = 0;
  for (std::size_t task = 1; task <= submission.tasks.size(); ++task) {
    const fs::path folder = submission.task_store(store.folder(), task);
    if (!fs::exists(folder / "store.sqlite")) continue;
    for (const auto& report : merge_stores(store, {folder})) checkpoints += report.checkpoints;
  }
  return checkpoints;
}

std::set<std::string> busy_runs(const Store& store, const std::vector<Submission>& open) {
  std::vector<std::string> runs;
  for (const Submission& submission : open) {
    if (submission.queue.empty()) continue;
    for (const auto& task : submission.tasks) runs.insert(runs.end(), task.begin(), task.end());
  }
  for (const Lease& lease : store.leases()) runs.push_back(lease.run);
  std::set<std::string> busy = with_parents(store, runs);
  for (const Stage& stage : store.stages()) {
    if (stage.kind == name_of(StageKind::prepare) && stage.state == StageState::completed)
      busy.erase(stage.id);
  }
  return busy;
}

void write_task_report(const fs::path& folder, const std::vector<Stage>& runs) {
  const json list = list_of(runs, [](const Stage& stage) -> json {
    return {{"id", stage.id}, {"state", name_of(stage.state)}, {"cycle", stage.cycle}};
  });
  try {
    write_output(report_file(folder), json{{"runs", list}}.dump() + "\n");
  } catch (const std::system_error&) {
    // Not an error: the report is only for information and is written again soon.
  }
}

std::map<std::string, Stage> read_task_report(const fs::path& folder) {
  std::map<std::string, Stage> reported;
  const json facts =
      parse_json(read_plain(report_file(folder), StoreLimits::value_bytes).value_or(""));
  try {
    for (const json& run : facts.at("runs")) {
      const auto state = value_of<StageState>(run.at("state").get_ref<const std::string&>());
      if (!state) continue;
      Stage& record = reported[run.at("id").get<std::string>()];
      record.state = *state;
      record.cycle = run.at("cycle").get<double>();
    }
  } catch (const json::exception&) {
    reported.clear();  // an invalid report is no error: reports are only for information
  }
  return reported;
}

QueueView view_queue(const Store& store) {
  QueueView view;
  view.submissions = unfinished_submissions(store);
  std::vector<std::string> names;
  for (const Submission& open : view.submissions) {
    names.insert(names.end(), {open.name(), open.merge_name()});
  }
  try {
    for (const QueuedTask& task : ask_queue(names)) {
      for (Submission& open : view.submissions) {
        if (task.name == open.name() || task.name == open.merge_name()) open.queue.push_back(task);
      }
    }
  } catch (const ProgramError& error) {
    view.problem = error.what();
  }
  for (const Submission& open : view.submissions) {
    for (std::size_t task = 1; task <= open.tasks.size(); ++task) {
      const auto reports = read_task_report(open.task_store(store.folder(), task));
      const QueuedTask queued = task_of(open, task);
      for (const std::string& id : with_parents(store, open.tasks[task - 1])) {
        QueuedRun& run = view.runs[id] = {queued, {}};  // newer submissions overwrite older ones
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
        "submission {}: its jobs have ended, but runs are unfinished; call `submit` again", s.id);
  }
  std::map<std::string, std::size_t> count;
  std::string merge_job;
  for (const QueuedTask& task : s.queue) {
    if (task.name == s.name()) ++count[lower(task.state)];
    if (task.name == s.merge_name()) merge_job = task.job;
  }
  std::vector<std::string> states;
  for (const auto& [state, tasks] : count) states.push_back(fmt::format("{} {}", tasks, state));
  return fmt::format(
      "submission {}: job {}, {} of {} tasks in the queue{}", s.id,
      s.job.empty() ? s.queue.front().job : s.job,
      states.empty() ? "none" : fmt::format("{}", fmt::join(states, ", ")), s.tasks.size(),
      merge_job.empty() ? "" : fmt::format("; job {} will merge the task stores", merge_job));
}

}  // namespace shearcell
