// SPDX-License-Identifier: GPL-3.0-or-later
// `verify`: whether the store still is what was written, and whether it can be computed again.
#include <fmt/format.h>

#include <charconv>
#include <memory>

#include "experiments/cli/command.hpp"
#include "experiments/runner/replay.hpp"
#include "experiments/runner/stop.hpp"
#include "experiments/runner/terminal.hpp"
#include "provenance/sha256.hpp"

namespace shearcell::cli {
namespace {

struct VerifyOptions {
  std::vector<std::string> against;
  std::size_t replay = 0;
  std::optional<std::uint64_t> seed;
  std::size_t threads = 1;
};

const char* name_of_severity(const Finding& finding) {
  return finding.severity == Finding::Severity::error ? "error" : "note";
}

// "16 ab12...", as two words or one, or with a colon between.
std::optional<Head> read_head(const std::vector<std::string>& words) {
  if (words.empty()) return std::nullopt;
  std::string text = words.size() == 2 ? words[0] + ":" + words[1] : words[0];
  if (const auto space = text.find(' '); space != std::string::npos) text[space] = ':';
  const auto colon = text.find(':');
  Head head;
  if (colon != std::string::npos) {
    const char* end = text.data() + colon;
    const auto [stop, error] = std::from_chars(text.data(), end, head.seq);
    head.hash = text.substr(colon + 1);
    if (error == std::errc() && stop == end && is_sha256_hex(head.hash)) return head;
  }
  throw CLI::ValidationError(
      "--against", "'" + text + "' is no head; give what `verify` told: SEQ and 64 hex digits");
}

// A new sample for every new event, and the same one again for the same store.
std::uint64_t seed_of(const Head& head) {
  std::uint64_t seed = 0;
  std::from_chars(head.hash.data(), head.hash.data() + 12, seed, 16);
  return seed;
}

nlohmann::json facts(const Replay& replay) {
  nlohmann::json all = {
      {"run", replay.record.run},     {"sha256", replay.record.sha256},
      {"cycle", replay.record.cycle}, {"from_step", replay.from ? replay.from->step : 0},
      {"step", replay.record.step},   {"steps", replay.steps},
      {"same", !replay.divergence}};
  if (const auto& d = replay.divergence) {
    all["divergence"] = {{"last_same_step", d->same_step},
                         {"first_step", d->first_step},
                         {"field", d->field},
                         {"grain", d->grain},
                         {"ulp", d->ulp},
                         {"why", d->message}};
  }
  return all;
}

std::string describe(const Replay& replay) {
  const std::string what = fmt::format("run {:.8}, cycle {:g}, {} steps", replay.record.run,
                                       replay.record.cycle, replay.steps);
  if (!replay.divergence) return what + ": the same state";
  const Divergence& d = *replay.divergence;
  std::string where;
  if (!d.field.empty()) {
    where = fmt::format("; largest in {}{}, {} ulp", d.field,
                        d.grain < 0 ? "" : fmt::format(" of grain {}", d.grain), d.ulp);
  }
  return fmt::format("{}: DIVERGED after step {} and not later than step {}: {}{}", what,
                     d.same_step, d.first_step, d.message, where);
}

nlohmann::json replay(const VerifyOptions& options, Context& context) {
  Store store(context.store, Access::write);
  const std::uint64_t seed = options.seed.value_or(seed_of(store.head()));
  const std::vector<CheckpointRecord> all = replayable(store);
  const std::vector<CheckpointRecord> chosen = sample(all, options.replay, seed);
  catch_stop_signals();
  nlohmann::json list = nlohmann::json::array();
  std::size_t left_out = 0;
  for (const RunRecord& run : store.runs()) {
    if (why_not_again(run)) left_out += store.checkpoints(run.id, true).size();
  }
  if (!context.json && left_out > 0) {
    fmt::print("{} checkpoints of LAMMPS are left out: it does not repeat bits\n", left_out);
  }
  if (!context.json) {
    tell("replaying up to {} of {} checkpoints, --seed {}\n", chosen.size(), all.size(), seed);
  }
  for (const CheckpointRecord& record : chosen) {
    const Replay result = verify_by_replay(store, record, options.threads);
    if (result.interrupted) {
      context.exit_code = kInterrupted;
      break;
    }
    if (result.divergence) context.exit_code = kStoreDamaged;
    list.push_back(facts(result));
    if (!context.json) tell("{}\n", describe(result));
  }
  return {{"seed", seed}, {"candidates", all.size()}, {"left_out", left_out}, {"replayed", list}};
}

nlohmann::json facts(const VerifyReport& report) {
  nlohmann::json findings = nlohmann::json::array();
  for (const Finding& finding : report.findings) {
    findings.push_back({{"severity", name_of_severity(finding)},
                        {"subject", finding.subject},
                        {"run", finding.run},
                        {"message", finding.message}});
  }
  return {{"ok", report.ok()},
          {"events", report.events},
          {"checkpoints", report.checkpoints},
          {"bytes", report.bytes},
          {"orphans", report.orphans},
          {"head", {{"seq", report.head.seq}, {"hash", report.head.hash}}},
          {"findings", findings}};
}

void print(const VerifyReport& report) {
  for (const Finding& finding : report.findings) {
    tell("{}: {}: {}\n", name_of_severity(finding), finding.subject, finding.message);
  }
  tell("{} events, {} checkpoints ({}), {} orphans: {}\nhead {} {}\n", report.events,
       report.checkpoints, format_bytes(static_cast<double>(report.bytes)), report.orphans,
       report.ok() ? "all as it was written" : "DAMAGED", report.head.seq, report.head.hash);
}

void verify(const VerifyOptions& options, Context& context) {
  const std::optional<Head> against = read_head(options.against);
  const VerifyReport report = Store(context.store, Access::read).verify(against);
  nlohmann::json all = facts(report);
  if (!context.json) print(report);
  if (!report.ok()) {
    context.exit_code = kStoreDamaged;
    if (options.replay > 0) fmt::print(stderr, "Not replayed: the store is damaged.\n");
  } else if (options.replay > 0) {
    all["replay"] = replay(options, context);
  }
  if (context.json) print_json(all);
}

}  // namespace

void add_verify(CLI::App& app, Context& context) {
  auto options = std::make_shared<VerifyOptions>();
  CLI::App* command =
      app.add_subcommand("verify", "Check the event chain, every file's hash and the projections");
  command->add_option("--against", options->against, "A head that an earlier `verify` printed")
      ->expected(1, 2)
      ->type_name("SEQ HASH");
  add_count(*command, "--replay", options->replay, "Recompute K sampled checkpoints", "K", 1,
            1'000'000'000);
  add_count(*command, "--seed", options->seed, "Seed of the sample (default: from the head)");
  add_threads_option(*command, options->threads, "Threads of a replay, for large cells");
  add_common_options(*command, context, true);
  command->footer(
      "--against proves that the log extends the earlier one. --replay steps from the checkpoint\n"
      "before each sampled one, compares every bit, and records the outcome.\n"
      "Examples:\n  shearcell verify --json\n  shearcell verify --replay 5\n"
      "  shearcell verify --against 16 4358ffe4f2a9...");
  command->callback([options, &context] { verify(*options, context); });
}

}  // namespace shearcell::cli
