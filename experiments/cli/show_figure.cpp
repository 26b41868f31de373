// SPDX-License-Identifier: GPL-3.0-or-later
// The part of `show` for figures and their files.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "experiments/cli/command.hpp"
#include "experiments/figures/lineage.hpp"
#include "experiments/manifest/document.hpp"
#include "provenance/errors.hpp"
#include "provenance/json_text.hpp"
#include "provenance/words.hpp"

namespace shearcell::cli {
namespace {

// Escapes a recorded text and cuts it to the rest of the terminal's line; in a pipe it stays whole.
std::string cut(const std::string& text, std::size_t used) {
  const std::string shown = without_controls(text);
  const std::size_t width = terminal_columns(stdout).value_or(std::string::npos);
  const std::size_t left = width > used + 3 ? width - used : 4;
  if (characters(shown) <= left) return shown;
  return std::string(first_characters(shown, left - 3)) + "...";
}

// "2026-11-20T21:40:51.123Z" as "2026-11-20 21:40:51".
std::string moment(const std::string& utc) {
  std::string text = utc.substr(0, 19);
  std::replace(text.begin(), text.end(), 'T', ' ');
  return text;
}

// Numbers builds and hosts, so that the lines of attempts stay short.
class Machines {
 public:
  std::size_t build(const nlohmann::json& host) {
    const nlohmann::json build = member_of(host, "build"), libraries = member_of(host, "libraries");
    Row lines = {
        fmt::format("shearcell {} ({}), {} {}", text_at(build, "version"), text_at(build, "commit"),
                    text_at(build, "compiler"), text_at(build, "type")),
        text_at(build, "flags")};
    std::string names;
    for (const auto& [name, version] : libraries.items()) {
      names += (names.empty() ? "" : ", ") + name + " " + text_at(libraries, name.c_str());
    }
    if (!names.empty()) lines.push_back(names);
    return number(builds_, lines);
  }
  std::size_t host(const nlohmann::json& host) {
    return number(hosts_, {text_at(host, "host") + ", " + text_at(host, "system"),
                           fmt::format("{}, {} cores, {}", text_at(host, "cpu"),
                                       text_at(host, "cores"), text_at(host, "simd"))});
  }
  void print() const {
    print("build", builds_);
    print("host", hosts_);
  }

 private:
  static std::size_t number(std::vector<Row>& known, const Row& lines) {
    const auto found = std::ranges::find(known, lines);
    const auto place = static_cast<std::size_t>(found - known.begin());
    if (found == known.end()) known.push_back(lines);
    return place + 1;
  }
  static void print(const char* what, const std::vector<Row>& all) {
    for (std::size_t k = 0; k < all.size(); ++k) {
      std::string name = fmt::format("{} {}", what, k + 1);
      for (const std::string& line : all[k]) {
        print_text("{:<9} {}\n", std::exchange(name, ""), cut(line, 10));
      }
    }
  }
  std::vector<Row> builds_, hosts_;  // lines to print
};

void print_manifests(const FigureLineage& lineage) {
  for (const ManifestText& manifest : lineage.manifests) {
    print_text("\nmanifest  {}\n  sha256  {}\n", cut(manifest.path, 10), manifest.sha256);
    std::map<int, std::string> lines;
    for (const FigureInput& input : lineage.inputs) {
      if (input.manifest != manifest.sha256) continue;
      for (const ManifestLine& line : input.lines) lines.emplace(line.line, line.text);
    }
    for (const auto& [number, text] : lines) {
      print_text("  line {:>4}  {}\n", number, cut(text, 13));
    }
  }
}

void print_attempts(const RunLineage& stage, Machines& machines) {
  for (std::size_t a = 0; a < stage.attempts.size(); ++a) {
    const Attempt& attempt = stage.attempts[a];
    print_text("  attempt {:<3} {}  {}, build {}, host {}\n", a + 1, moment(attempt.started_at),
               name_of(attempt.outcome), machines.build(attempt.host), machines.host(attempt.host));
    if (!attempt.why.empty()) print_text("              {}\n", cut(attempt.why, 14));
    if (!attempt.from_checkpoint.empty()) {
      print_text("  from        {}\n", attempt.from_checkpoint);
    }
  }
}

void print_checkpoints(const std::vector<std::string>& checkpoints, const RunLineage& run) {
  print_text("  {:>6}  {:>2}  checkpoint\n", "cycle", "at");
  for (const std::string& sha256 : checkpoints) {
    const CheckpointHistory* known = run.find(sha256);
    const bool has_attempt = known != nullptr && known->attempt;
    print_text("  {:>6}  {:>2}  {}\n",
               known != nullptr ? fmt::format("{:g}", known->record.cycle) : "?",
               has_attempt ? std::to_string(*known->attempt + 1) : "?", sha256);
  }
}

void print_input(const FigureInput& input, const RunLineage& run, Machines& machines) {
  std::set<int> numbers;
  for (const ManifestLine& line : input.lines) numbers.insert(line.line);
  const std::string lines = numbers.empty() ? "?" : fmt::format("{}", fmt::join(numbers, ", "));
  print_text("\nrun       {}\n", input.run);
  print_text("  {}\n", cut(fmt::format("{} {}, seed {}, {} grains; manifest {:.8}, lines {}",
                                       input.experiment, input.variant, input.seed, run.run.grains,
                                       input.manifest, lines),
                           2));
  if (input.overrides.is_object()) {
    for (const auto& [key, values] : input.overrides.items()) {
      print_text("  {}\n", cut(fmt::format("given at the command line: {} {} (manifest: {})", key,
                                           text_at(values, "run"), text_at(values, "manifest")),
                               2));
    }
  }
  print_attempts(run, machines);
  print_checkpoints(input.checkpoints, run);
}

void print_stage_before(const RunLineage& stage, Machines& machines) {
  print_text("\nbefore    {}\n  {}, seed {}, {} grains\n", stage.run.id, cut(stage.run.kind, 50),
             text_at(stage.run.resolved, "seed"), stage.run.grains);
  print_attempts(stage, machines);
  std::vector<std::string> checkpoints;
  for (const CheckpointHistory& c : stage.checkpoints) {
    if (c.record.state != CheckpointState::rejected) checkpoints.push_back(c.record.sha256);
  }
  print_checkpoints(checkpoints, stage);
}

void print(const FigureLineage& lineage) {
  const nlohmann::json& facts = lineage.record.provenance;
  Machines machines;
  const nlohmann::json made = member_of(facts, "made");
  std::string by;
  if (made.is_object()) {
    by = fmt::format(", build {}, host {}", machines.build(made), machines.host(made));
  }
  const std::string scale = text_at(facts, "scale");
  print_text("figure    {}, {} scale, analysis version {}\n", cut(lineage.record.name, 40),
             cut(scale_name(scale), 50), text_at(facts, "analysis_version"));
  print_text("made      {} UTC, event {}{}\n", moment(lineage.record.recorded_at),
             lineage.record.seq, by);
  std::size_t widest = 0;
  for (const auto& [name, sha256] : lineage.outputs) {
    widest = std::max(widest, cut(name, 66).size());
  }
  for (const auto& [name, sha256] : lineage.outputs) {
    print_text("  {:<{}}  {}\n", cut(name, 66), widest, sha256);
  }
  print_manifests(lineage);
  for (const FigureInput& input : lineage.inputs) {
    print_input(input, lineage.runs.at(input.run), machines);
  }
  for (const auto& [id, stage] : lineage.runs) {
    if (std::ranges::count(lineage.inputs, id, &FigureInput::run) == 0) {
      print_stage_before(stage, machines);
    }
  }
  print_text("\n");
  machines.print();
}

nlohmann::json check_json(const std::filesystem::path& file, const PublishedFile& found,
                          const std::vector<InputFault>& faults, std::size_t inputs) {
  const auto fault_facts = [](const InputFault& fault) -> nlohmann::json {
    return {{"run", fault.run}, {"checkpoint", fault.checkpoint}, {"what", fault.what}};
  };
  return {{"file", file.string()},
          {"sha256", found.sha256},
          {"recorded_sha256", found.recorded},
          {"verdict", found.matches() ? "matches" : "changed"},
          {"inputs", inputs},
          {"input_faults", json_list(faults, fault_facts)}};
}

void print_check(const std::filesystem::path& file, const PublishedFile& found,
                 const std::vector<InputFault>& faults, std::size_t inputs) {
  print_text("file      {}\n", cut(file.string(), 10));
  if (found.matches()) {
    print_text("verdict   matches what event {} recorded\n", found.record.seq);
  } else {
    print_text("verdict   WAS CHANGED since event {}, or another store made it\n",
               found.record.seq);
    print_text("  is      {}\n  was     {}\n", found.sha256, found.recorded);
  }
  if (faults.empty()) {
    print_text("inputs    {}, all present and right\n\n", counted(inputs, "checkpoint"));
    return;
  }
  const auto pruned = std::ranges::count(faults, "pruned", &InputFault::what);
  const auto changed = std::ssize(faults) - pruned;
  print_text("inputs    {}: {} present and right{}{}\n", counted(inputs, "checkpoint"),
             inputs - faults.size(), pruned > 0 ? fmt::format(", {} pruned", pruned) : "",
             changed > 0 ? fmt::format(", {} missing or changed", changed) : "");
  for (const InputFault& fault : faults) print_text("  {}\n  {}\n", fault.checkpoint, fault.what);
  print_text("\n");
}

}  // namespace

void show_figure(const Store& store, const FigureRecord& record, Context& context) {
  const FigureLineage lineage = figure_lineage(store, record);
  if (context.json) return print_json(to_json(lineage));
  print(lineage);
}

void show_published(const Store& store, const std::filesystem::path& file, Context& context) {
  const auto found = find_published(store, file);
  if (!found) {
    throw NotFound(
        file.string() +
        ": unknown to this store: no figure that it recorded has a file with these bytes "
        "or of this name; name the right store with --store");
  }
  const FigureLineage lineage = figure_lineage(store, found->record);
  const std::vector<InputFault> faults = check_inputs(store, lineage);
  // A pruned checkpoint is not damage.
  const bool damaged =
      std::ranges::any_of(faults, [](const InputFault& f) { return f.what != "pruned"; });
  if (damaged || !found->matches()) fail(context, kStoreDamaged);
  std::size_t inputs = 0;
  for (const FigureInput& input : lineage.inputs) inputs += input.checkpoints.size();
  if (context.json) {
    nlohmann::json all = to_json(lineage);
    all["check"] = check_json(file, *found, faults, inputs);
    return print_json(all);
  }
  print_check(file, *found, faults, inputs);
  print(lineage);
}

}  // namespace shearcell::cli
