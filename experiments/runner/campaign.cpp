// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/campaign.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <utility>

#include "core/filling.hpp"
#include "core/threads.hpp"
#include "experiments/manifest/identity.hpp"
#include "experiments/runner/outlook.hpp"
#include "experiments/runner/registered.hpp"
#include "experiments/runner/repeated.hpp"
#include "experiments/runner/stop.hpp"
#include "experiments/runner/terminal.hpp"
#include "provenance/errors.hpp"
#include "provenance/io/child_process.hpp"
#include "provenance/io/clock.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

using Clock = std::chrono::steady_clock;

// ended: this campaign will not complete the stage.
enum class JobState { waiting, running, done, ended };

// Time between two checks of a stage that another process computes.
constexpr std::chrono::milliseconds kCheckInterval{500};
// A stage is blocked if more than this number of its attempts ended with StageOutcome::lost and no
// other process is computing it.
constexpr int kMostLosses = 20;

// --- Progress on standard error ---

/// On a terminal: one line per running stage, redrawn in place. Elsewhere: a line when a stage
/// begins or ends, and at most one line per running stage every ten seconds. Thread-safe.
class Progress {
 public:
  Progress(std::size_t stages, bool quiet)
      : stages_(stages), quiet_(quiet), terminal_(moves_cursor(stderr)) {}
  ~Progress() { erase(); }

  void begin(const StageJob& job) {
    const std::lock_guard lock(mutex_);
    running_[job.id] = {job.name, "starting", {}};
    if (terminal_ || quiet_) return;
    print_stderr("{}: started ({} of {} stages done)\n", job.name, done_, stages_);
  }

  void update(const StageJob& job, const std::string& text) {
    const std::lock_guard lock(mutex_);
    Shown& shown = running_[job.id];
    shown.text = text;
    if (quiet_) return;
    if (terminal_) return draw();
    if (shown.said.seconds() < 10) return;
    shown.said.restart();
    print_stderr("{}: {}\n", shown.name, shown.text);
  }

  /// `how`: how the stage ended; printed unless empty. `done`: whether the stage counts as done.
  void end(const StageJob& job, const std::string& how, bool done) {
    const std::lock_guard lock(mutex_);
    running_.erase(job.id);
    if (done) ++done_;
    if (!quiet_ && !how.empty()) {
      erase();
      print_stderr("{}: {} ({} of {} stages done)\n", job.name, how, done_, stages_);
    }
    draw();
  }

  /// Prints a permanent line. A `minor` line is printed only if progress is shown.
  void say(const std::string& line, bool minor = false) {
    const std::lock_guard lock(mutex_);
    if (minor && quiet_) return;
    erase();
    print_stderr("{}\n", line);
    draw();
  }

 private:
  struct Shown {
    std::string name, text;
    Stopwatch said;
  };

  void erase() {
    for (; drawn_ > 0; --drawn_) write_stderr("\x1b[1A\x1b[2K");
  }

  void draw() {
    if (quiet_ || !terminal_) return;
    erase();
    // erase() does not erase the beginning of a line that wraps.
    const std::size_t longest = terminal_columns(stderr).value_or(80) - 1;
    std::multimap<std::string, std::string> lines;
    for (const auto& [id, shown] : running_) lines.emplace(shown.name, shown.text);
    for (const auto& [name, text] : lines) {
      const std::string line = for_terminal(fmt::format("{:<28} {}", name, text));
      print_stderr("{}\n", first_columns(line, longest));
      ++drawn_;
    }
  }

  std::mutex mutex_;
  std::size_t stages_, done_ = 0;
  bool quiet_, terminal_;
  std::size_t drawn_ = 0;                 ///< lines on the screen that the next draw() replaces
  std::map<std::string, Shown> running_;  ///< by stage id
};

// --- Scheduling ---

class Campaign {
 public:
  Campaign(Store& store, const std::vector<StageJob>& jobs, const Parallel& parallel, bool quiet,
           std::function<void(const std::string&)> when_done)
      : store_(store),
        progress_(jobs.size(), quiet),
        parallel_(parallel),
        when_done_(std::move(when_done)) {
    for (const StageJob& job : jobs) jobs_.push_back({job});
  }

  CampaignResult run(std::size_t workers) {
    // Tells other processes that this process is alive, even during long simulations. If another
    // process has taken over a stage, the store rejects what this process records for the stage.
    const Repeated heartbeat(
        std::chrono::duration<double>(store_.lease_seconds() / 4),
        [this] { store_.renew_leases(); }, [](const std::exception&) {});
    {
      const auto threads = start_threads(workers, [this](std::size_t) { work(); });
      work();
    }
    if (error_) std::rethrow_exception(error_);
    return result_;
  }

 private:
  struct Job : StageJob {
    JobState state = JobState::waiting;
    // When to try again. Empty until an attempt finds that another process computes the stage.
    std::optional<Clock::time_point> check_at = {};
    int losses = 0;  // number of attempts that ended with StageOutcome::lost
  };

  // Returns the first job that can begin, or else the first job whose `check_at` has passed, or
  // else null. Jobs that can no longer begin get the state JobState::ended.
  Job* next_job() {
    Job* held_job = nullptr;
    for (Job& job : jobs_) {
      if (job.state != JobState::waiting) continue;
      const JobState before = parent_state(job);
      if (before == JobState::ended || error_ || stop_requested()) {
        job.state = JobState::ended;
        ++(was_done(job) ? result_.already : result_.blocked);
      } else if (before == JobState::done) {
        if (!job.check_at) return &job;
        if (held_job == nullptr && Clock::now() >= *job.check_at) held_job = &job;
      }
    }
    return held_job;
  }

  // For a job that this campaign does not start: whether the stage is done (Outlook::done).
  // Computes no measures, because that would take too long.
  bool was_done(const StageJob& job) const {
    try {
      return look_at(store_, store_.stage(job.id)).done;
    } catch (const std::exception&) {
      return false;  // the next attempt to compute the stage reports the error
    }
  }

  JobState parent_state(const Job& job) const {
    const auto parent = std::ranges::find(jobs_, job.parent, &Job::id);
    if (parent != jobs_.end()) return parent->state;
    return JobState::done;  // no parent, or the parent is not in this campaign
  }

  std::size_t count(JobState state) const {
    return static_cast<std::size_t>(std::ranges::count(jobs_, state, &Job::state));
  }

  void work() {
    std::unique_lock lock(mutex_);
    for (;;) {
      Job* const job = next_job();
      if (job == nullptr) {
        const auto is_held = [](const Job& one) {
          return one.state == JobState::waiting && one.check_at;
        };
        const auto held = static_cast<std::size_t>(std::ranges::count_if(jobs_, is_held));
        if (held == 0 && (count(JobState::waiting) == 0 || count(JobState::running) == 0)) break;
        if (held > 0) show_waiting(held);
        changed_.wait_for(lock, kCheckInterval);
        continue;
      }
      job->state = JobState::running;
      lock.unlock();
      const JobState state = run_job(*job);
      lock.lock();
      job->state = state;
      changed_.notify_all();
    }
    changed_.notify_all();
  }

  void show_waiting(std::size_t held) {
    if (count(JobState::running) > 0 || held == shown_held_) return;
    std::set<std::string> holders;
    try {
      for (const Lease& lease : store_.leases()) holders.insert(describe(lease.holder));
    } catch (const std::exception&) {
      return;  // the next attempt to compute a stage reports the error
    }
    if (holders.empty()) return;  // the other process has just ended
    shown_held_ = held;
    progress_.say(
        fmt::format("waiting for {} that another process is computing ({}). If that process "
                    "ends or is silent for {} s, its stages are continued here",
                    counted(held, "stage"), fmt::join(holders, "; "), kLongestLeaseMs / 1000),
        true);
  }

  JobState run_job(Job& job) {
    try {
      return compute(job);
    } catch (const StoreDamaged& damage) {
      note(job, &CampaignResult::damaged, damage.what());
    } catch (const GeometryError& error) {
      note(job, &CampaignResult::failed, error.what());
    } catch (const UnreadableRecord& error) {
      note(job, &CampaignResult::blocked, error.what());
    } catch (const ProgramError& error) {
      note(job, &CampaignResult::blocked, error.what());  // LAMMPS is missing
    } catch (const NotFound& error) {
      // The checkpoint from which the stage starts was pruned or never recorded.
      note(job, &CampaignResult::blocked, error.what());
    } catch (const TooLittleMemory& error) {
      note(job, &CampaignResult::failed, error.what());
    } catch (const std::exception& error) {
      progress_.say(job.name + ": " + error.what());
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
    }
    progress_.end(job, "", false);
    return JobState::ended;
  }

  bool held_by_another(const std::string& run) const {
    const std::vector<Lease> leases = store_.leases();
    return std::ranges::find(leases, run, &Lease::run) != leases.end();
  }

  JobState put_off(Job& job) {
    job.check_at = Clock::now() + kCheckInterval;
    return JobState::waiting;
  }

  JobState compute(Job& job) {
    const bool was_held = job.check_at.has_value();
    const Stage stage = store_.stage(job.id);
    if (is_done(store_, stage)) {
      finish(job, was_held ? &CampaignResult::elsewhere : &CampaignResult::already,
             was_held ? "completed by another process" : "", true);
      return JobState::done;
    }
    if (held_by_another(job.id)) return put_off(job);
    if (was_held && stage.state == StageState::failed) {
      // The stage failed in another process. It would fail in this process, too.
      note(job, &CampaignResult::failed, stage.error);
      return JobState::ended;
    }
    progress_.begin(job);
    StageOptions options{.parallel = parallel_};
    options.damaged = [&](const std::string& what) {
      note(job, &CampaignResult::damaged, what + "; continuing from an earlier checkpoint");
    };
    options.continuing = [&](const std::string& what) { say(job, what); };
    options.restoring = [&](const std::string& what) {
      progress_.say(fmt::format("{}: {}", job.name, what), true);
    };
    options.report = [&](const std::string& text) { progress_.update(job, text); };
    const StageOutcome outcome = run_stage(store_, job.id, options);
    switch (outcome) {
      case StageOutcome::completed:
      case StageOutcome::already: {
        const bool now = outcome == StageOutcome::completed;
        const std::string why = describe_end(end_of(store_.stage(job.id)));
        if (now && when_done_) when_done_(job.id);
        finish(job, now ? &CampaignResult::completed : &CampaignResult::already,
               why.empty() ? "done" : "done, " + why, true);
        return JobState::done;
      }
      case StageOutcome::interrupted:
        finish(job, &CampaignResult::interrupted, "interrupted", false);
        return JobState::ended;
      case StageOutcome::failed:
        note(job, &CampaignResult::failed, store_.stage(job.id).error);
        progress_.end(job, "FAILED", false);
        return JobState::ended;
      case StageOutcome::lost:
        progress_.end(job, "", false);
        if (++job.losses > kMostLosses && !held_by_another(job.id)) {
          note(job, &CampaignResult::blocked,
               "the stage cannot be started; `shearcell verify` may show why");
          return JobState::ended;
        }
        return put_off(job);
    }
    return JobState::ended;
  }

  void finish(const StageJob& job, std::size_t CampaignResult::*count, const std::string& how,
              bool done) {
    {
      const std::lock_guard lock(mutex_);
      ++(result_.*count);
    }
    progress_.end(job, how, done);
  }

  void note(const StageJob& job, std::size_t CampaignResult::*count, const std::string& why) {
    say(job, why);
    const std::lock_guard lock(mutex_);
    const bool again = count == &CampaignResult::damaged && !damaged_.insert(job.id).second;
    if (!again) ++(result_.*count);
  }

  void say(const StageJob& job, const std::string& what) {
    const std::string line = fmt::format("{} ({:.12}): {}", job.name, job.id, what);
    progress_.say(line);
    const std::lock_guard lock(mutex_);
    result_.messages.push_back(line);
  }

  Store& store_;
  Progress progress_;
  Parallel parallel_;
  std::function<void(const std::string&)> when_done_;
  std::mutex mutex_;  // guards the members below
  std::condition_variable changed_;
  std::vector<Job> jobs_;
  std::size_t shown_held_ = 0;
  CampaignResult result_;
  std::set<std::string> damaged_;  // ids of the stages in result_.damaged
  std::exception_ptr error_;
};

/// A job for each stage, named after the first experiment, variant and seed that use the stage. If
/// jobs have the same name, for example at several scales, each name ends with the stage's id.
std::vector<StageJob> jobs_of(const std::vector<Stage>& stages, const VariantNames& names) {
  std::vector<StageJob> jobs;
  std::map<std::string, std::size_t> count;
  for (const Stage& stage : stages) {
    std::string name = stage.kind;
    if (!stage.memberships.empty()) {
      const Place& place = stage.memberships.front().place;
      name = fmt::format("{} {} seed={}", place.experiment, names.of(stage, place), place.seed);
    }
    ++count[name];
    jobs.push_back({stage.id, stage.parent, name});
  }
  for (StageJob& job : jobs) {
    if (count[job.name] > 1) job.name += " " + job.id.substr(0, 8);
  }
  return jobs;
}

nlohmann::json overlap_limits(const Manifest& manifest) {
  nlohmann::json limits = nlohmann::json::object();
  for (const Scale& scale : scales_of(manifest)) {
    const auto found = scale.settings.find("max_overlap_diameters");
    if (found != scale.settings.end()) limits[scale.name] = found->second.value;
  }
  return limits;
}

}  // namespace

std::vector<StageJob> declare(Store& store, const Plan& plan) {
  const Manifest& manifest = plan.manifest;
  nlohmann::json info = {{"experiment", manifest.experiment},
                         {"question", manifest.question},
                         {"figures", manifest.figures}};
  if (auto limits = overlap_limits(manifest); !limits.empty()) {
    info["max_overlap_diameters"] = std::move(limits);
  }
  store.register_manifest(manifest.text, manifest.file, info);
  if (plan.file) store.register_packing(plan.file->text, plan.file->path);
  std::vector<Stage> stages;
  std::set<std::string> known;
  for (const PlannedRun& run : plan.runs) {
    for (const Stage* stage : {run.prepare ? &*run.prepare : nullptr, &run.stage}) {
      if (stage == nullptr) continue;
      const bool first = known.insert(stage->id).second;
      if (!first && stage != &run.stage) continue;  // several variants share this packing
      store.declare_stage(*stage);
      if (first) stages.push_back(*stage);
    }
  }
  return jobs_of(stages, VariantNames(store));
}

std::vector<StageJob> stages_to_resume(Store& store, const std::vector<std::string>& prefixes) {
  std::vector<std::string> asked;
  for (const std::string& prefix : prefixes) asked.push_back(store.find_stage(prefix).id);
  std::vector<Stage> stages = store.stages();
  for (const Stage& stage : stages) {
    if (prefixes.empty() && !look_at(store, stage).done) asked.push_back(stage.id);
  }
  // Parents are included: a parent whose last checkpoint is lost must be computed again.
  const std::set<std::string> wanted = with_parents(store, asked);
  std::erase_if(stages, [&](const Stage& stage) { return !wanted.contains(stage.id); });
  return jobs_of(stages, VariantNames(store));
}

CampaignResult run_campaign(Store& store, const std::vector<StageJob>& jobs, std::size_t workers,
                            const Parallel& parallel, bool quiet,
                            std::function<void(const std::string& stage)> when_done) {
  return Campaign(store, jobs, parallel, quiet, std::move(when_done)).run(workers);
}

}  // namespace shearcell
