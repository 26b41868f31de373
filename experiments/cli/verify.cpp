// SPDX-License-Identifier: GPL-3.0-or-later
// `verify`: checks that the store is unchanged and, on request, that its states can be recomputed.
// `rebuild`: rebuilds the tables of the store from its events.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "experiments/cli/command.hpp"
#include "experiments/runner/audit.hpp"
#include "experiments/runner/stage.hpp"
#include "experiments/runner/stop.hpp"
#include "provenance/io/read_number.hpp"
#include "provenance/sha256.hpp"
#include "provenance/words.hpp"

namespace shearcell::cli {
namespace {

struct VerifyOptions {
  std::vector<std::string> against;  ///< two words: number and hash of an event
  std::size_t replay = 0;
  std::size_t measures = 8;
  std::optional<std::uint64_t> seed;
  std::size_t threads = 1;
};

const char* name_of_severity(const Finding& finding) {
  using enum Finding::Severity;
  return finding.severity == error ? "error" : finding.severity == note ? "note" : "not checked";
}

std::optional<Head> read_head(const std::vector<std::string>& words) {
  if (words.empty()) return std::nullopt;
  const auto seq = read_number<std::uint64_t>(words.front());
  if (seq && is_sha256_hex(words.back())) return Head{*seq, words.back()};
  throw CLI::ValidationError("--against",
                             fmt::format("'{}' is not a head; give the number and hash of an event "
                                         "as `verify` prints them",
                                         fmt::join(words, " ")));
}

nlohmann::json facts(const Replay& replay) {
  nlohmann::json all = {
      {"run", replay.record.run},     {"sha256", replay.record.sha256},
      {"cycle", replay.record.cycle}, {"from_step", replay.from ? replay.from->step : 0},
      {"step", replay.record.step},   {"steps", replay.steps},
      {"same", !replay.divergence}};
  if (replay.divergence) all["divergence"] = to_json(*replay.divergence);
  return all;
}

std::string describe(const Replay& replay) {
  const std::string what = fmt::format("run {:.8}, cycle {:g}, {} steps", replay.record.run,
                                       replay.record.cycle, replay.steps);
  if (!replay.divergence) return what + ": the same state";
  const Divergence& d = *replay.divergence;
  std::string where;
  if (!d.field.empty()) {
    where = fmt::format("; largest difference in {}{}, {} ulp", d.field,
                        d.grain < 0 ? "" : fmt::format(" of grain {}", d.grain), d.ulp);
  }
  return fmt::format("{}: DIVERGED: same at step {}, different at step {}: {}{}", what, d.same_step,
                     d.first_step, d.message, where);
}

nlohmann::json replay(const VerifyOptions& options, Context& context) {
  Store store(context.store, Access::write);
  const std::uint64_t seed = options.seed.value_or(seed_of(store.head()));
  std::size_t left_out = 0, skipped = 0;
  std::vector<CheckpointRecord> all = replayable(store, &left_out);
  // The replay of a checkpoint at step 0 computes no steps and proves little. Such checkpoints are
  // used only if there are no others.
  const auto is_beginning = [](const CheckpointRecord& record) { return record.step == 0; };
  if (!std::ranges::all_of(all, is_beginning)) std::erase_if(all, is_beginning);
  const std::size_t count = std::min(options.replay, all.size());
  catch_stop_signals();
  nlohmann::json list = nlohmann::json::array();
  if (!context.json) {
    if (left_out > 0) {
      print_text(
          "{} left out: not bitwise reproducible (computed by LAMMPS or with another "
          "bits_version)\n",
          counted(left_out, "checkpoint"));
    }
    print_text("replaying up to {} of {}, --seed {}\n", count, counted(all.size(), "checkpoint"),
               seed);
  }
  for (const CheckpointRecord& record : sample(all, all.size(), seed)) {
    if (list.size() == count) break;
    try {
      const Replay result = verify_by_replay(store, record, options.threads);
      if (result.interrupted) {
        fail(context, kInterrupted);
        break;
      }
      if (result.divergence) fail(context, kStoreDamaged);
      list.push_back(facts(result));
      if (!context.json) print_text("{}\n", describe(result));
    } catch (const FilePruned&) {
      ++skipped;
    }
  }
  if (!context.json && skipped > 0) {
    print_text(
        "{} skipped: all earlier states were pruned; `shearcell regenerate --all` recomputes the "
        "pruned files\n",
        counted(skipped, "checkpoint"));
  }
  return {{"seed", seed},
          {"candidates", all.size()},
          {"left_out", left_out},
          {"skipped", skipped},
          {"replayed", list}};
}

nlohmann::json facts(const VerifyReport& report) {
  const auto finding_facts = [](const Finding& finding) -> nlohmann::json {
    return {{"severity", name_of_severity(finding)},
            {"subject", finding.subject},
            {"run", finding.run},
            {"message", finding.message}};
  };
  return {{"ok", report.ok()},
          {"events", report.events},
          {"checkpoints", report.checkpoints},
          {"bytes", report.bytes},
          {"orphans", report.orphans},
          {"head", {{"seq", report.head.seq}, {"hash", report.head.hash}}},
          {"findings", list_of(report.findings, finding_facts)}};
}

// Checks runs and cached measures, and adds findings to the report. Does nothing if the store is
// damaged or a file cannot be read, because the checks read records and files.
MeasureCheck audit(const Store& store, const VerifyOptions& options, VerifyReport& report) {
  MeasureCheck measures;
  if (!report.ok() || report.count(Finding::Severity::unread) > 0) return measures;
  for (Finding& finding : check_runs(store)) report.findings.push_back(std::move(finding));
  if (!report.ok()) return measures;
  measures = check_measures(store, options.measures, options.seed.value_or(seed_of(report.head)));
  for (const Finding& finding : measures.findings) report.findings.push_back(finding);
  return measures;
}

void print(const VerifyReport& report, const MeasureCheck& measures) {
  for (const Finding& finding : report.findings) {
    print_text("{}: {}: {}\n", name_of_severity(finding), finding.subject, finding.message);
  }
  print_text("{}, {} ({}), {}: {}\nhead {} {}\n", counted(report.events, "event"),
             counted(report.checkpoints, "checkpoint"), format_bytes(report.bytes),
             counted(report.orphans, "orphan"),
             !report.ok()                                  ? "DAMAGED"
             : report.count(Finding::Severity::unread) > 0 ? "not everything was checked"
             : measures.absent > 0                         ? "measures are missing"
                                                           : "nothing was changed",
             report.head.seq, report.head.hash);
  if (measures.cached > 0) {
    print_text("recomputed the cached measures of {} of {}\n", measures.computed,
               counted(measures.cached, "checkpoint"));
  }
  if (measures.absent > 0) {
    print_text(
        "measures of pruned checkpoints: {} missing; restore derived.sqlite from a backup, or run "
        "`shearcell regenerate --all`\n",
        measures.absent);
  }
  if (measures.not_covered > 0) {
    print_text("not covered: {}, because the log has no hashes of the measures\n",
               counted(measures.not_covered, "pruned checkpoint"));
  }
  if (report.ok()) {
    print_text(
        "Keep a copy of the head elsewhere. `verify --against SEQ HASH` can later prove that no "
        "event up to this head was changed or removed.\n");
  }
}

void verify(const VerifyOptions& options, Context& context) {
  const std::optional<Head> against = read_head(options.against);
  const Store store(context.store, Access::read);
  VerifyReport report = store.verify(against);
  const MeasureCheck measures = audit(store, options, report);
  nlohmann::json all = facts(report);
  all["measures"] = {{"kept", measures.cached},
                     {"computed_again", measures.computed},
                     {"not_covered_checkpoints", measures.not_covered},
                     {"absent", measures.absent}};
  if (!context.json) print(report, measures);
  if (report.count(Finding::Severity::unread) > 0) fail(context, kOtherError);
  if (!report.ok()) {
    fail(context, kStoreDamaged);
    if (options.replay > 0) print_stderr("Not replayed: the store is damaged.\n");
  } else if (options.replay > 0) {
    all["replay"] = replay(options, context);
  }
  if (context.json) print_json(all);
}

void rebuild(Context& context) {
  Store store(context.store, Access::write);
  store.rebuild();
  const std::vector<Stage> runs = store.stages();
  const Head head = store.head();
  if (context.json) {
    print_json({{"events", head.seq}, {"runs", runs.size()}});
  } else {
    fmt::print("{} rebuilt from {}\n", counted(runs.size(), "run"), counted(head.seq, "event"));
  }
}

}  // namespace

void add_verify(CLI::App& app, Context& context) {
  const auto [command, options] =
      add_command(app, context, "verify",
                  "Check the event chain, the hash of every file and the derived tables", verify);
  command
      ->add_option("--against", options->against,
                   "Number and hash of the last event, as an earlier `verify` printed them")
      ->expected(2)
      ->type_name("SEQ HASH");
  add_number(*command, "--replay", options->replay,
             "Recompute K sampled checkpoints and compare every bit", "K", 1, 1'000'000'000);
  add_number(*command, "--measures", options->measures,
             "Recompute the cached measures of K sampled checkpoints (default: 8)", "K");
  add_number(*command, "--seed", options->seed,
             "Random seed (default: derived from the hash of the last event)");
  add_threads_option(*command, options->threads, "Threads of a replay");
  add_common_options(
      *command, context,
      R"(Proves that no event or file was changed or lost, and that the tables follow from the events. Each
file must match its event (step, cycle, time, units, grains, observables, state). Each run must have
the parameters and swept values of its id, and must have begun from a completed packing. Cached
measures of pruned checkpoints must match the hashes that the log records.
--replay K recomputes K sampled checkpoints from earlier checkpoints, compares every bit of the
state and of the values recorded with it, and records the outcome. A checkpoint is skipped if all
earlier files were pruned. --measures K recomputes the cached measures of K sampled checkpoints.
Not proved: states that are not sampled; when, where and how fast a run was computed; trajectories
of LAMMPS. A log that was rewritten from its first event, or whose end was cut off, is not detected.
To detect such changes, keep the printed head away from the store and pass the head to --against.
Examples:
  shearcell verify --json
  shearcell verify --replay 5
  shearcell verify --against 16 4358ffe4f2a9...)");
}

void add_rebuild(CLI::App& app, Context& context) {
  CLI::App* command =
      app.add_subcommand("rebuild", "Rebuild the tables of the store from its events");
  command->callback([&context] { rebuild(context); });
  add_common_options(
      *command, context,
      R"(Use this command if `verify` reports wrong tables. Events and checkpoints do not change.
Examples:
  shearcell rebuild)");
}

}  // namespace shearcell::cli
