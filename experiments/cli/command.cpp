// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/cli/command.hpp"

#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string/classification.hpp>
#include <boost/algorithm/string/split.hpp>
#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <ranges>
#include <set>
#include <span>
#include <system_error>

#include "provenance/io/file.hpp"
#include "provenance/limits.hpp"
#include "provenance/sha256.hpp"
#include "provenance/words.hpp"

namespace shearcell::cli {
namespace {

bool is_stdout(const std::string& out) {
  return out == "-" || out == "/dev/stdout";
}

CLI::Option* add_each(CLI::App& command, const char* name, auto& values, const char* help,
                      const char* type) {
  return command.add_option(name, values, std::string(help) + "; may be repeated")
      ->type_name(type)
      ->allow_extra_args(false);
}

void add_variant_and_seed(CLI::App& command, std::vector<std::string>& variants,
                          std::vector<std::uint64_t>& seeds) {
  add_each(
      command, "--variant", variants,
      "Only runs with this swept value (KEY=V, such as fluid=cell) or with this label. Both may be "
      "written as `status` prints them. For each key that is given, a run must have one of the "
      "values given for this key",
      "KEY=V");
  const auto take = [&seeds](const std::vector<std::string>& lists) {
    for (const std::string& list : lists) {
      std::vector<std::string> parts;
      for (const std::string& part : boost::split(parts, list, boost::is_any_of(","))) {
        const auto more = read_seeds(part, "--seed");
        seeds.insert(seeds.end(), more.begin(), more.end());
      }
    }
  };
  command
      .add_option_function<std::vector<std::string>>(
          "--seed", take, "Only runs with these seeds, such as 6 or 6,8 or 6-9; may be repeated")
      ->allow_extra_args(false)
      ->type_name("N");
}

bool starts_from_a_run(const Manifest& manifest) {
  return std::ranges::any_of(scales_of(manifest),
                             [](const Scale& scale) { return scale.start.is_recorded(); });
}

// Sorts the manifests so that each run comes after the run from which it starts. A `start` without
// an experiment may refer to a run of any experiment, so manifests whose runs do not start from
// other runs come first.
void order_by_start(std::vector<Manifest>& manifests) {
  std::ranges::stable_partition(manifests, std::not_fn(starts_from_a_run));
  for (auto next = manifests.begin(); next != manifests.end(); ++next) {
    const auto waits = [&](const Manifest& one) {
      const std::vector<Scale> scales = scales_of(one);
      return std::any_of(next, manifests.end(), [&](const Manifest& other) {
        const auto starts_here = [&](const Scale& scale) {
          return scale.start.experiment == other.experiment;
        };
        return &one != &other && std::ranges::any_of(scales, starts_here);
      });
    };
    const auto ready = std::find_if_not(next, manifests.end(), waits);
    // If each remaining manifest starts from runs of another remaining manifest, no order is
    // possible, and expand() reports the missing runs.
    if (ready == manifests.end()) return;
    std::rotate(next, ready, ready + 1);
  }
}

// Figures show only the runs of the newest manifest of each experiment and scale. `known` are the
// runs in the store and in earlier plans of the same command. Warns if figures will omit some of
// these runs after this plan is run.
void warn_of_other_version(const Plan& plan, const std::vector<Stage>& known, Context& context) {
  const Manifest& manifest = plan.manifest;
  std::set<std::string> planned;
  for (const PlannedRun& run : plan.runs) planned.insert(run.stage.id);
  const std::string own = sha256_hex(manifest.text);
  const auto left_out = std::ranges::count_if(known, [&](const Stage& stage) {
    if (stage.kind == name_of(StageKind::prepare) || planned.contains(stage.id)) return false;
    return std::ranges::any_of(stage.memberships, [&](const Membership& m) {
      return m.newest && m.place.manifest != own && m.place.experiment == manifest.experiment &&
             m.place.scale == plan.scale;
    });
  });
  if (left_out == 0) return;
  warn(context,
       fmt::format(
           "{}: the newest manifest of experiment {} differs from this file and has {} "
           "that the plan of this file lacks. If you run this plan, figures will omit the runs "
           "that the plan lacks. To show all runs, run one manifest that lists all of them; runs "
           "that are already in the store are not computed again.",
           manifest.file, manifest.experiment, counted(static_cast<std::size_t>(left_out), "run")));
}

}  // namespace

void fail(Context& context, ExitCode code) {
  const auto gravity = [](int of) { return of == kInterrupted ? 0.5 : of; };
  if (gravity(code) > gravity(context.exit_code)) context.exit_code = code;
}

std::optional<Store> open_if_there(const std::string& folder) {
  // An empty folder is not a store yet: `run` creates a store in it.
  std::error_code ignored;
  if (!std::filesystem::exists(folder) ||
      (std::filesystem::is_directory(folder) && std::filesystem::is_empty(folder, ignored))) {
    return std::nullopt;
  }
  return std::optional<Store>(std::in_place, folder, Access::read);
}

void print_problems(const MeasureOutcome& outcome, const char* left_out, Context& context) {
  constexpr std::size_t most = 8;
  for (const auto* lines : {&outcome.damage, &outcome.pruned}) {
    for (const std::string& line : *lines | std::views::take(most)) {
      print_stderr("{}: {}\n", left_out, line);
    }
    if (lines->size() <= most) continue;
    print_stderr("{}: {}\n", left_out, counted(lines->size() - most, "more checkpoint"));
  }
  if (!outcome.cache_trouble.empty()) {
    print_stderr("measures cannot be cached: {}\n", outcome.cache_trouble);
  }
  if (!outcome.damage.empty()) fail(context, kStoreDamaged);
}

std::string unfit_output(const std::string& path) {
  namespace fs = std::filesystem;
  if (path.empty()) return "is empty; give a file or folder";
  std::error_code ignored;
  // Output in a store's `objects` is refused: `verify` would call it a leftover of a crash.
  for (fs::path at = fs::absolute(path).lexically_normal(); at.has_relative_path();
       at = at.parent_path()) {
    const fs::path log = at.parent_path() / "store.sqlite";
    if (at.filename() != "objects" || !fs::exists(log, ignored)) continue;
    return at.string() + " is where a store keeps its checkpoints; choose another path";
  }
  return "";
}

std::string unfit_folder(const std::string& path) {
  return path == "-" ? "means standard output, but a folder is needed; give a folder"
                     : unfit_output(path);
}

bool is_stream(const std::string& out) {
  std::error_code missing;
  const std::filesystem::file_type type = std::filesystem::status(out, missing).type();
  // Accepts pipes of the shell, such as `>(gzip)`. Opening other pipes would wait for a reader.
  const bool pipe = type == std::filesystem::file_type::fifo && out.starts_with("/dev/fd/");
  return is_stdout(out) || pipe || type == std::filesystem::file_type::character;
}

void write_result(const std::string& out, const std::string& text) {
  if (is_stdout(out)) {
    fmt::print("{}", terminal_columns(stdout) ? for_terminal(text) : text);
  } else if (is_stream(out)) {
    const Descriptor stream(open(out.c_str(), O_WRONLY | O_CLOEXEC));
    if (!stream.valid()) fail_on(out, "write");
    write_all(stream, std::as_bytes(std::span(text)), out);
  } else {
    write_output(out, text);
  }
}

void add_json_option(CLI::App& command, Context& context) {
  command.add_flag("--json", context.json, "Print the result as JSON");
}

void add_common_options(CLI::App& command, Context& context, const std::string& footer) {
  command.add_option("--store", context.store, "Folder of the store (overrides $SHEARCELL_STORE)")
      ->default_str(
          Context{}.store)  // not $SHEARCELL_STORE, so the manual is the same on all machines
      ->check(unfit_folder)
      ->type_name("DIR");
  add_json_option(command, context);
  command.footer(footer);
}

std::filesystem::path existing_folder(const std::string& store) {
  std::filesystem::path place = std::filesystem::absolute(store);
  std::error_code ignored;  // a folder without access permission is treated as missing
  while (!is_directory(place, ignored) && place.has_relative_path()) place = place.parent_path();
  return place;
}

void add_manifest_options(CLI::App& command, std::vector<std::string>& manifests,
                          ExpandOptions& options, bool engines) {
  command.add_option("manifest", manifests, "YAML manifests")->required();
  command.add_option("--scale", options.scale, "Scale to use (default: desk)");
  add_number(command, "--cycles", options.cycles,
             "Number of cycles, instead of the number in the manifest. The store keeps the largest "
             "number that was ever requested",
             "N", 0, StoreLimits::cycles);
  add_number(command, "--seeds", options.seeds,
             "Number of seeds, instead of the number in the manifest. Runs with other seeds stay "
             "in the store",
             "N", 1);
  add_variant_and_seed(command, options.variants, options.only_seeds);
  if (!engines) return;
  command
      .add_option("--engine", options.engine,
                  "Program that simulates the shear (default: shearcell)")
      ->check(one_of<EngineKind>())
      ->type_name("NAME");
}

void add_selection_options(CLI::App& command, RunSelection& selection, bool states) {
  add_each(command, "--experiment", selection.experiments, "Only runs of this experiment", "NAME");
  add_each(command, "--scale", selection.scales, "Only runs of this scale", "NAME");
  add_variant_and_seed(command, selection.variants, selection.seeds);
  if (!states) return;
  add_each(command, "--state", selection.states, "Only runs in this state", "STATE")
      ->check(one_of<StageState>());
}

std::vector<PlacedRun> by_run(const std::vector<Run>& selected) {
  std::vector<PlacedRun> runs;
  std::map<std::string, std::size_t> known;  // run id -> index in `runs`
  for (const Run& run : selected) {
    const auto [at, fresh] = known.try_emplace(run.stage.id, runs.size());
    if (fresh) runs.push_back({run.stage, {}});
    runs[at->second].places.push_back({run.place, run.ask, run.newest});
  }
  return runs;
}

void warn(Context& context, const std::string& warning) {
  print_stderr("warning: {}\n", warning);
  context.warnings.push_back(warning);
}

std::vector<Plan> load_plans(const std::vector<std::string>& paths, const ExpandOptions& options,
                             Context& context, bool brief) {
  constexpr std::size_t most = 3;  // warnings printed for one manifest
  std::vector<Manifest> manifests;
  std::set<std::string> read;
  for (const std::string& path : paths) {
    if (read.insert(path).second) manifests.push_back(load_manifest(path));
  }
  order_by_start(manifests);
  std::vector<Stage> known;
  try {
    if (const auto store = open_if_there(context.store)) known = store->stages();
  } catch (const std::exception&) {
    // Not reported here: the command opens the store once more and then reports the error.
  }
  ExpandOptions with_known = options;
  std::vector<Plan> plans;
  for (const Manifest& manifest : manifests) {
    with_known.known = known;
    const Plan& plan = plans.emplace_back(expand(manifest, with_known));
    if (brief && plan.warnings.size() > most) {
      warn(context, fmt::format("{}; `shearcell plan` prints {} more warnings",
                                plan.warnings.front(), plan.warnings.size() - 1));
    } else {
      for (const std::string& warning : plan.warnings) warn(context, warning);
    }
    warn_of_other_version(plan, known, context);
    add_as_computed(plan, known);
  }
  return plans;
}

void add_threads_option(CLI::App& command, std::size_t& threads, const std::string& what) {
  const std::string help = what + "; more than one is useful for large cells";
  add_number(command, "--threads,-t", threads, help, "T", 1, 1024);
}

void print_json(const nlohmann::json& facts) {
  // Paths and hostnames may contain invalid UTF-8, which is replaced. Characters beyond ASCII are
  // escaped, since a terminal may interpret some of them as commands.
  fmt::print("{}\n", facts.dump(2, ' ', true, nlohmann::json::error_handler_t::replace));
}

std::string format_bytes(double bytes) {
  const char* unit = "B";
  for (const char* larger : {"kB", "MB", "GB", "TB"}) {
    if (bytes < 1000) break;
    bytes /= 1000;
    unit = larger;
  }
  return fmt::format("{:.3g} {}", bytes, unit);
}

}  // namespace shearcell::cli
