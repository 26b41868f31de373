// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/outlook.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "core/drive.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/identity.hpp"
#include "experiments/manifest/manifest.hpp"
#include "provenance/errors.hpp"
#include "provenance/json_text.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

// Largest number of checkpoints listed for one stage. Only a stage in a forged store has more.
constexpr std::size_t kMostListed = 1'000'000;
constexpr double kMostCounted = 10'000;  // larger numbers of checkpoints are estimated

std::optional<Until> until_of(const Stage& stage, const Ask& ask) try {
  if (ask.until.is_null()) return std::nullopt;
  return until_from_json(ask.until);
} catch (const std::runtime_error& problem) {
  throw StoreDamaged(fmt::format("run {:.8}: invalid `until`: {}", stage.id, problem.what()));
}

/// The contents of a recorded Outlook::ended.
struct EarlyEnd {
  Until until;
  double reached = 0;  ///< the cycle at which `until` was reached
};

/// Empty if `until` did not end the stage, or if this program cannot read the record.
std::optional<EarlyEnd> early_end(const json& ended) {
  const json measure = member_of(ended, "measure"), cycle = member_of(ended, "reached_at_cycle");
  if (member_of(ended, "by") != "until" || !measure.is_string() || !cycle.is_number()) return {};
  try {
    const json until = {{measure.get<std::string>(), member_of(ended, "value")},
                        {"extra_cycles", member_of(ended, "extra_cycles")}};
    return EarlyEnd{until_from_json(until), cycle.get<double>()};
  } catch (const std::runtime_error&) {
    return {};
  }
}

/// The cycle at which the stage reached `until`, if this was recorded when the stage completed.
std::optional<double> recorded_reach(const Stage& stage, const Until& until, double every) {
  for (const json& ended : stage.ends) {
    const auto end = early_end(ended);
    if (end && end->until == until && std::fmod(end->reached, every) == 0) return end->reached;
  }
  return std::nullopt;
}

/// Where a stage ends if only one Ask (the request of one experiment) is considered.
struct End {
  double cycle = 0;                             ///< Ask::target_cycles, or less because of `until`
  std::optional<double> reached = {};           ///< the cycle at which `until` was reached
  const CheckpointRecord* undecided = nullptr;  ///< first unmeasured checkpoint
};

End end_by(const Stage& stage, const Ask& ask, std::span<const CheckpointRecord> checkpoints,
           const KnownMeasures& measures) {
  End end{static_cast<double>(ask.target_cycles)};
  const std::optional<Until> until = until_of(stage, ask);
  if (!until) return end;
  const auto every = static_cast<double>(ask.checkpoint_every);
  for (const CheckpointRecord& one : checkpoints) {
    if (std::fmod(one.cycle, every) != 0) continue;
    const auto known = measures.find(one.sha256);
    if (known == measures.end() || !known->second.numbers.contains(until->measure)) {
      // A recorded end is valid only for requests of at most stage.target_cycles cycles. For a
      // request of more cycles, `until` must be tested at this checkpoint.
      if (ask.target_cycles <= stage.target_cycles) {
        end.reached = recorded_reach(stage, *until, every);
      }
      if (!end.reached) end.undecided = &one;
      break;
    }
    // A measure may be NaN, such as phi if no grain is interior. NaN does not fulfil `until`.
    if (!(known->second.number(until->measure) >= until->value)) continue;
    end.reached = one.cycle;
    break;
  }
  if (end.reached) {
    // The stage ends at the first regular checkpoint at or after cycle `last`.
    const double last = *end.reached + static_cast<double>(until->extra_cycles);
    end.cycle = std::min(end.cycle, std::ceil(last / every) * every);
  }
  return end;
}

/// Whether a completed stage needs no more cycles for `ask`, which has an `until`; see outlook().
bool is_covered(const Stage& stage, const Ask& ask) {
  return stage.state == StageState::completed && !ask.until.is_null() &&
         std::ranges::any_of(asks_of(stage.memberships), [&](const Ask& recorded) {
           return recorded.until == ask.until && recorded.target_cycles >= ask.target_cycles &&
                  recorded.checkpoint_every % ask.checkpoint_every == 0;
         });
}

/// Sets the outlook's `end`, `may_end_early`, `ended` and `undecided`. Returns whether the stage is
/// long enough for all requests.
bool find_end(const Stage& stage, std::span<const Ask> asks,
              std::span<const CheckpointRecord> checkpoints, const KnownMeasures& measures,
              Outlook& look) {
  bool long_enough = true, reached = true;
  double latest = -1, known = 0, at_most = 0;  // at_most: latest possible end
  for (const Ask& ask : asks) {
    const End end = end_by(stage, ask, checkpoints, measures);
    const bool earlier =
        end.undecided != nullptr && (!look.undecided || end.undecided->step < look.undecided->step);
    if (earlier) look.undecided = *end.undecided;
    reached = reached && stage.cycle >= end.cycle;
    const bool met = stage.cycle >= end.cycle || is_covered(stage, ask);
    long_enough = long_enough && met;
    double& last = met || end.reached || ask.until.is_null() ? known : at_most;
    last = std::max(last, met ? std::min(end.cycle, stage.cycle) : end.cycle);
    if (!end.reached || end.cycle <= latest) continue;
    latest = end.cycle;
    const Until until = *until_of(stage, ask);
    look.ended = {{"by", "until"},
                  {"measure", until.measure},
                  {"value", until.value},
                  {"extra_cycles", until.extra_cycles},
                  {"reached_at_cycle", *end.reached},
                  {"memberships", asks.size()}};
  }
  look.end = std::max(known, at_most);
  look.may_end_early = at_most > known;
  if (!reached) look.ended = nullptr;
  return long_enough;
}

/// Estimated simulated time [s] in which a packing settles. The estimate differs by less than a
/// third from measured times: 0.9, 1.1, 1.6 and 2.8 s at N = 600, 2000, 5200 and 18200.
double settling_time_s(const Parameters& p) {
  const double height = p.height_over_width * cell_width(geometry(p));
  const double time = 0.6 + 0.00175 * height * height;
  return std::min(std::max({time, damping_time_s(p), pressing_time_s(p)}), p.settle_time_limit_s);
}

/// Estimated number of force evaluations of one minimization at the default tolerance. The measured
/// means over the nine minimizations of a stiffening (supplement B.2) are 8.2e3, 16e3 and 52e3 at
/// N = 600, 2000 and 7900. The estimate differs from them by less than a sixth.
double minimization_evaluations(double grains) {
  return 18e3 * std::pow(grains / 2000, 0.7);
}

/// Sets the remaining work of a shear that ends at cycle look.end.
void find_left(const Stage& stage, const Drive& motion, EngineKind engine,
               std::span<const Ask> asks, std::span<const CheckpointRecord> checkpoints,
               Outlook& look) {
  const double length = look.end * static_cast<double>(cycle_steps(motion));
  const auto now = static_cast<double>(stage.step);
  AskedCheckpoints asked = asked_checkpoints(stage, asks, checkpoints, 0, look.end);
  look.checkpoints = asked.to_come;
  if (engine == EngineKind::shearcell) look.missing = std::move(asked.missing);
  double steps = std::max(0.0, length - now);
  // Number of steps that a replay computes to reach step `last`. The replay starts from the last
  // checkpoint before `first` that has a file, or from step 0 if there is no such checkpoint.
  const auto steps_again = [&](std::uint64_t first, std::uint64_t last) {
    std::uint64_t from = 0;
    for (const CheckpointRecord& record : checkpoints) {
      if (record.state == CheckpointState::recorded && record.step < first) from = record.step;
    }
    return static_cast<double>(last - from);
  };
  const bool pruned = !checkpoints.empty() && checkpoints.back().state == CheckpointState::pruned;
  if (length > now && pruned) {  // the last checkpoint must be recomputed first
    steps += steps_again(checkpoints.back().step, checkpoints.back().step);
  }
  if (!look.missing.empty()) {
    steps += steps_again(look.missing.front(), look.missing.back());
    look.checkpoints += static_cast<double>(look.missing.size());
  }
  look.particle_steps = static_cast<double>(stage.grains) * steps;
}

}  // namespace

Outlook outlook(const Stage& stage, std::span<const Ask> asks,
                std::span<const CheckpointRecord> checkpoints, const KnownMeasures& measures) {
  Outlook look;
  const bool long_enough = find_end(stage, asks, checkpoints, measures, look);
  const bool completed = stage.state == StageState::completed;
  try {
    const StageInputs known = read_stage(stage.resolved);
    const Parameters& p = known.parameters;
    const auto grains = static_cast<double>(stage.grains);
    if (known.stage == StageKind::shear) {
      find_left(stage, drive(p), p.engine, asks, checkpoints, look);
    } else if (known.stage == StageKind::stiffen) {
      const double left = std::max(0.0, look.end - stage.cycle);
      look.particle_steps = grains * minimization_evaluations(grains) * left;
      look.checkpoints = left + (checkpoints.empty() ? 1 : 0);
    } else if (!completed) {
      const double time = known.file && !known.file->settles ? 0 : settling_time_s(p);
      look.particle_steps = grains * time / p.settle_time_step_s;
      look.checkpoints = 1 + std::floor(time / 2);
    }
    look.bytes = look.checkpoints * checkpoint_bytes(geometry(p));
  } catch (const UnreadableRecord& problem) {
    look.unreadable = problem.what();
  }
  look.done = completed && long_enough && look.missing.empty();
  return look;
}

std::optional<Drive> shear_drive(const Stage& stage) {
  if (stage.kind != name_of(StageKind::shear)) return std::nullopt;
  try {
    return drive(read_stage(stage.resolved).parameters);
  } catch (const UnreadableRecord&) {
    return std::nullopt;
  }
}

std::vector<CheckpointCadence> cadences_of(const Stage& stage, std::span<const Ask> asks,
                                           const Drive& drive) {
  std::vector<CheckpointCadence> cadences;
  for (const Ask& ask : asks) {
    if (ask.checkpoint_phases.size() > ManifestLimits::values_per_list) {
      throw StoreDamaged(fmt::format("run {:.8}: too many recorded checkpoint_phases: {}", stage.id,
                                     ask.checkpoint_phases.size()));
    }
    if (ask.target_cycles == 0) continue;  // every shear stage records cycle 0
    cadences.push_back(
        {ask.checkpoint_every, steps_at(ask.checkpoint_phases, drive), ask.target_cycles});
  }
  return cadences;
}

AskedCheckpoints asked_checkpoints(const Stage& stage, std::span<const Ask> asks,
                                   std::span<const CheckpointRecord> checkpoints, double first,
                                   double last) {
  AskedCheckpoints asked;
  const std::optional<Drive> motion = shear_drive(stage);
  if (asks.empty() || !motion) {
    std::ranges::copy_if(checkpoints, std::back_inserter(asked.made), [&](const auto& record) {
      const double cycle = record.cycle;
      return cycle == std::floor(cycle) && cycle >= first && cycle <= last;
    });
    return asked;
  }
  const auto whole = static_cast<double>(cycle_steps(*motion));
  const double end = std::min(last, static_cast<double>(StoreLimits::cycles)) * whole;
  const std::vector<CheckpointCadence> cadences = cadences_of(stage, asks, *motion);
  const auto begin = static_cast<std::uint64_t>(std::ceil(first * whole));
  std::uint64_t step = begin == 0 ? 0 : next_checkpoint(cadences, *motion, begin - 1);
  auto next = checkpoints.begin();
  for (std::size_t k = 0; k < kMostListed && static_cast<double>(step) <= end; ++k) {
    const auto known =
        std::ranges::equal_range(next, checkpoints.end(), step, {}, &CheckpointRecord::step);
    next = known.end();
    if (!known.empty()) {
      asked.made.insert(asked.made.end(), known.begin(), known.end());
    } else if (step < stage.step) {
      asked.missing.push_back(step);
    } else if (++asked.to_come == kMostCounted) {
      const auto now = static_cast<double>(stage.step);
      asked.to_come *= (end - now) / (static_cast<double>(step) - now);
      break;
    }
    step = next_checkpoint(cadences, *motion, step);
  }
  return asked;
}

std::uint64_t checkpoint_cadence(std::span<const Ask> asks) {
  std::uint64_t cadence = 0;
  for (const Ask& ask : asks) cadence = std::gcd(cadence, ask.checkpoint_every);
  return std::max<std::uint64_t>(cadence, 1);
}

// --- Outlooks of the stages of a store or a plan ---

namespace {

[[noreturn]] void refuse_unread(const CheckpointRecord& record) {
  const bool pruned = record.state == CheckpointState::pruned;
  const std::string why = fmt::format(
      "checkpoint {:.12} of run {:.12} (cycle {:g}) {}, but it may decide where the run ends "
      "(`until`); `shearcell regenerate {:.12}` restores it",
      record.sha256, record.run, record.cycle, pruned ? "was pruned" : "cannot be read",
      record.sha256);
  if (pruned) throw FilePruned(why);
  throw StoreDamaged(why);
}

/// Adds to `measures` the measures that the `until` conditions in `asks` use, of the checkpoints at
/// whole cycles from `first` on: all that are cached if `cached`, else one per worker, analysed.
void measure_from(const Store& store, const Stage& stage, std::span<const Ask> asks,
                  const CheckpointRecord& first, std::span<const CheckpointRecord> checkpoints,
                  bool cached, KnownMeasures& measures, const MeasureOptions& options) {
  std::set<std::string> wanted;
  std::vector<std::string> providers;
  for (const Ask& ask : asks) {
    const std::optional<Until> until = until_of(stage, ask);
    if (!until || !wanted.insert(until->measure).second) continue;
    providers.push_back(provider_of(*find_measure(until->measure)).name);
  }
  std::vector<CheckpointMeasures> chosen;
  for (const CheckpointRecord& one : checkpoints) {
    if (one.step < first.step || one.cycle != std::floor(one.cycle)) continue;
    const Measures& known = measures[one.sha256];
    const auto is_known = [&](const std::string& name) { return known.numbers.contains(name); };
    if (std::ranges::all_of(wanted, is_known)) continue;
    chosen.push_back({one});
    if (!cached && chosen.size() == options.workers) break;
  }
  std::vector<ToMeasure> todo;
  for (CheckpointMeasures& one : chosen) todo.push_back({&one});
  MeasureOptions how = {
      .workers = options.workers, .report = options.report, .only_cached = cached};
  // These measures cost nothing extra in an analysis. Figures need them later.
  if (!cached) how.also = {scalars_provider, "crystallites"};
  measure_checkpoints(store, todo, providers, how);
  if (!cached && !chosen.front().lacking.empty()) refuse_unread(first);
  for (CheckpointMeasures& one : chosen) {
    if (!one.lacking.empty()) continue;
    // A number that the checkpoint lacks is set to NaN, which never fulfils an `until`.
    for (const std::string& name : wanted) one.measures.numbers.try_emplace(name, std::nan(""));
    measures[one.sha256] = std::move(one.measures);
  }
}

/// The largest requested number of cycles that the stage has reached; 0 if it has reached none of
/// the requests. Ignores requests with this `until`, and requests recorded after the stage ended.
double longest_length(const Stage& stage, const json& ended, const json& until) {
  const json known = member_of(ended, "memberships");
  std::size_t left = known.is_number_unsigned() ? known.get<std::size_t>() : 0;
  double longest = 0;
  for (const Ask& ask : asks_of(stage.memberships)) {  // in the order of declaration
    if (left-- == 0) break;
    const auto cycles = static_cast<double>(ask.target_cycles);
    if (cycles <= stage.cycle && ask.until != until) longest = std::max(longest, cycles);
  }
  return longest;
}

}  // namespace

Outlook look_at(const Store& store, const Stage& stage) {
  try {
    return outlook(stage, asks_of(stage.memberships),
                   store.checkpoints(stage.id, Listed::and_pruned));
  } catch (const StoreDamaged& damage) {
    const bool completed = stage.state == StageState::completed;
    return {.done = completed, .unreadable = damage.what()};
  }
}

std::vector<PlannedStage> look_at(std::span<const Plan> plans, const Store* store) {
  std::map<std::string, Stage> known;
  if (store != nullptr) {
    for (Stage& stage : store->stages()) known.emplace(stage.id, std::move(stage));
  }
  std::vector<PlannedStage> stages;
  std::map<std::string, std::size_t> places;  // index in `stages`, by id
  const auto add = [&](const PlannedRun& run, const Stage& planned) {
    const auto [place, fresh] = places.try_emplace(planned.id, stages.size());
    if (fresh) stages.push_back({.run = &run, .stage = planned});
    PlannedStage& one = stages[place->second];
    if (const auto found = known.find(planned.id); fresh && found != known.end()) {
      one.stage = std::move(found->second);
      one.stage.resolved = planned.resolved;  // the store's copy may be damaged
      one.memberships = one.stage.memberships;
      one.checkpoints = store->checkpoints(one.stage.id, Listed::and_pruned);
    }
    std::ranges::copy(planned.memberships, std::back_inserter(one.memberships));
  };
  for (const Plan& plan : plans) {
    for (const PlannedRun& run : plan.runs) {
      if (run.prepare) add(run, *run.prepare);
      add(run, run.stage);
    }
  }
  for (PlannedStage& one : stages) {
    one.look = outlook(one.stage, asks_of(one.memberships), one.checkpoints);
  }
  return stages;
}

Outlook measured_outlook(const Store& store, const Stage& stage, std::span<const Ask> asks,
                         std::span<const CheckpointRecord> checkpoints, KnownMeasures& measures,
                         const MeasureOptions& options) {
  // A running stage asks after each checkpoint, which is not cached yet.
  for (bool cached = measures.empty();; cached = false) {
    Outlook look = outlook(stage, asks, checkpoints, measures);
    if (!look.undecided) return look;
    measure_from(store, stage, asks, *look.undecided, checkpoints, cached, measures, options);
  }
}

double end_for(const Store& store, const Stage& stage, const Ask& ask,
               const MeasureOptions& options) {
  // If only one experiment uses the stage, no other experiment has continued it beyond `until`.
  if (stage.memberships.size() < 2 || ask.until.is_null()) {
    return static_cast<double>(ask.target_cycles);
  }
  KnownMeasures measures;
  const auto checkpoints = store.checkpoints(stage.id, Listed::and_pruned);
  return measured_outlook(store, stage, {&ask, 1}, checkpoints, measures, options).end;
}

std::vector<CheckpointRecord> checkpoints_for(const Store& store, const Stage& stage,
                                              std::span<const Ask> asks,
                                              const MeasureOptions& options) {
  std::vector<CheckpointRecord> all = store.checkpoints(stage.id, Listed::and_pruned);
  std::set<std::uint64_t> steps;
  for (const Ask& ask : asks) {
    const double end = end_for(store, stage, ask, options);
    for (const auto& one : asked_checkpoints(stage, {&ask, 1}, all, 0, end).made) {
      steps.insert(one.step);
    }
  }
  std::erase_if(all, [&](const CheckpointRecord& one) { return !steps.contains(one.step); });
  return all;
}

json end_of(const Stage& stage) {
  const bool before_last = stage.cycle < static_cast<double>(stage.target_cycles);
  if (stage.state != StageState::completed || stage.ends.empty() || !before_last) return json();
  json ended = stage.ends.back();
  const auto end = early_end(ended);
  if (!end) return json();
  const double reached = end->reached + static_cast<double>(end->until.extra_cycles);
  const double asked = longest_length(stage, ended, to_json(end->until));
  if (asked > reached) ended["cycles_asked"] = asked;
  return ended;
}

std::string describe_end(const json& ended) {
  if (ended.is_null()) return "";
  const auto extra = ended.at("extra_cycles").get<std::uint64_t>();
  std::string why =
      fmt::format("{} >= {} at cycle {}{}", ended.at("measure").get<std::string>(),
                  ended.at("value").get<double>(), ended.at("reached_at_cycle").get<double>(),
                  extra > 0 ? fmt::format(", then {}", counted(extra, "more cycle")) : "");
  if (const json asked = member_of(ended, "cycles_asked"); !asked.is_null()) {
    why = fmt::format("an experiment asks for {}; {}", counted(asked.get<std::size_t>(), "cycle"),
                      why);
  }
  return why;
}

std::optional<double> expected_end(std::span<const Stage> stages, const json& until) {
  double sum = 0, count = 0;
  for (const Stage& stage : stages) {
    const json ended = end_of(stage);
    const auto end = early_end(ended);
    if (!end || ended.contains("cycles_asked") || to_json(end->until) != until) continue;
    sum += stage.cycle;
    ++count;
  }
  if (count == 0) return std::nullopt;
  return sum / count;
}

// --- Estimates of memory, file sizes and time ---

namespace {

// Rates [particle-steps/s] for stores without measured rates. Source: `bench speed` for cells with
// rough walls, on one core of an EPYC (Zen 4). For LAMMPS (29 Sep 2021) the source is SCALING.md.
struct MeasuredRate {
  double grains, rate;
};
constexpr MeasuredRate kOurRates[] = {{5200, 74e6}, {1e5, 57e6}, {1e6, 53e6}};
constexpr MeasuredRate kLammpsRates[] = {{5200, 6.6e6}, {1e5, 3.0e6}};

// Interpolates by a power law in N; constant below the smallest and above the largest measured N.
double assumed_rate(std::span<const MeasuredRate> rates, double grains) {
  std::size_t i = 1;
  while (i + 1 < rates.size() && rates[i].grains < grains) ++i;
  const MeasuredRate &a = rates[i - 1], &b = rates[i];
  const double part = std::log(grains / a.grains) / std::log(b.grains / a.grains);
  return a.rate * std::pow(b.rate / a.rate, std::clamp(part, 0.0, 1.0));
}

// Measured size [bytes] of a checkpoint file: per grain, per wall grain, and a constant part.
constexpr double kBytesPerGrain = 121;
constexpr double kBytesPerWallGrain = 98;
constexpr double kBytesPerFile = 18e3;

}  // namespace

double run_bytes(const Geometry& shape) {
  return kRunBytesPerGrain * (static_cast<double>(shape.grains) + wall_grain_count(shape));
}

double checkpoint_bytes(const Geometry& shape) {
  return kBytesPerFile + kBytesPerGrain * static_cast<double>(shape.grains) +
         kBytesPerWallGrain * wall_grain_count(shape);
}

Rates::Rates(const std::vector<Stage>& stages) {
  for (const Stage& stage : stages) {
    Effort& sum = sums_[engine_of(stage.resolved)];
    sum.particle_steps += stage.particle_steps;
    sum.wall_seconds += stage.wall_seconds;
  }
}

Rate Rates::of(const Stage& stage) const {
  const EngineKind engine = engine_of(stage.resolved);
  const auto grains = static_cast<double>(stage.grains);
  const auto sum = sums_.find(engine);
  if (sum != sums_.end() && sum->second.wall_seconds >= 1) {
    return {sum->second.particle_steps / sum->second.wall_seconds, true};
  }
  const bool ours = engine == EngineKind::shearcell;
  return {ours ? assumed_rate(kOurRates, grains) : assumed_rate(kLammpsRates, grains), false};
}

void Work::add(const Stage& stage, const Outlook& look, const Rates& rates) {
  const Rate of_stage = rates.of(stage);
  const double own_seconds = look.particle_steps / of_stage.particle_steps_per_second;
  ++stages;
  particle_steps += look.particle_steps;
  bytes += look.bytes;
  core_seconds += own_seconds;
  if (core_seconds > 0) {
    rate = particle_steps / core_seconds;
  } else if (rate == 0) {
    rate = of_stage.particle_steps_per_second;
  }
  measured = measured && of_stage.measured;
  longest_seconds = std::max(longest_seconds, chain[stage.id] = chain[stage.parent] + own_seconds);
}

double Work::seconds(std::size_t at_a_time) const {
  return std::max(longest_seconds, core_seconds / static_cast<double>(at_a_time));
}

std::set<std::string> with_parents(const Store& store, const std::vector<std::string>& stages) {
  std::set<std::string> all;
  for (const std::string& stage : stages) {
    for (std::string id = stage; !id.empty() && all.insert(id).second;) id = store.stage(id).parent;
  }
  return all;
}

bool has_failed(const Store& store, const Stage& stage) {
  if (has_ended(stage.state)) return stage.state == StageState::failed;
  return !stage.parent.empty() && store.stage(stage.parent).state == StageState::failed;
}

}  // namespace shearcell
