// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/cli/show_figure.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "experiments/figures/lineage.hpp"
#include "experiments/manifest/document.hpp"
#include "experiments/runner/terminal.hpp"
#include "provenance/errors.hpp"

namespace shearcell::cli {
namespace {

// A recorded text, fit for a terminal and for what is left of its line; whole in a file or a pipe.
std::string cut(const std::string& text, std::size_t used) {
  const auto width = terminal_columns(stdout);
  if (!width) return printable(text, std::string::npos);
  const std::size_t left = *width > used + 3 ? *width - used : 4;
  const std::string shown = printable(text, std::string::npos);
  if (characters(shown) <= left) return shown;
  return std::string(first_characters(shown, left - 3)) + "...";
}

std::string text_at(const nlohmann::json& object, const char* key) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  if (!object.is_object() || found == object.end()) return "?";
  return found->is_string() ? found->get<std::string>() : found->dump();
}

nlohmann::json at(const nlohmann::json& object, const char* key) {
  return object.is_object() ? object.value(key, nlohmann::json()) : nlohmann::json();
}

// "2026-11-20 21:40:51" of "2026-11-20T21:40:51.123Z".
std::string moment(const std::string& utc) {
  std::string text = utc.substr(0, 19);
  std::replace(text.begin(), text.end(), 'T', ' ');
  return text;
}

// Builds and hosts, each named by a number so that a line about an attempt stays short.
class Machines {
 public:
  std::size_t build(const nlohmann::json& host) {
    return number(builds_, {{"build", at(host, "build")}, {"libraries", at(host, "libraries")}});
  }
  std::size_t host(const nlohmann::json& host) {
    nlohmann::json machine = nlohmann::json::object();
    for (const char* key : {"host", "system", "cpu", "cores", "simd"}) machine[key] = at(host, key);
    return number(hosts_, machine);
  }
  void print() const {
    for (std::size_t b = 0; b < builds_.size(); ++b) {
      const nlohmann::json& build = builds_[b]["build"];
      tell("build {}   {}\n", b + 1,
           cut(fmt::format("shearcell {} ({}), {} {}", text_at(build, "version"),
                           text_at(build, "commit"), text_at(build, "compiler"),
                           text_at(build, "type")),
               10));
      tell("          {}\n", cut(text_at(build, "flags"), 10));
      std::string libraries;
      for (const auto& [name, version] : builds_[b]["libraries"].items()) {
        libraries += (libraries.empty() ? "" : ", ") + name + " " +
                     text_at(builds_[b]["libraries"], name.c_str());
      }
      if (!libraries.empty()) tell("          {}\n", cut(libraries, 10));
    }
    for (std::size_t h = 0; h < hosts_.size(); ++h) {
      const nlohmann::json& host = hosts_[h];
      tell("host {}    {}\n", h + 1,
           cut(text_at(host, "host") + ", " + text_at(host, "system"), 10));
      tell("          {}\n", cut(fmt::format("{}, {} cores, {}", text_at(host, "cpu"),
                                             text_at(host, "cores"), text_at(host, "simd")),
                                 10));
    }
  }

 private:
  static std::size_t number(std::vector<nlohmann::json>& known, const nlohmann::json& facts) {
    const auto found = std::find(known.begin(), known.end(), facts);
    if (found != known.end()) return static_cast<std::size_t>(found - known.begin()) + 1;
    known.push_back(facts);
    return known.size();
  }
  std::vector<nlohmann::json> builds_;
  std::vector<nlohmann::json> hosts_;
};

void print_manifests(const FigureLineage& lineage) {
  for (const ManifestText& manifest : lineage.manifests) {
    tell("\nmanifest  {}\n  sha256  {}\n", cut(manifest.path, 10), manifest.sha256);
    std::vector<ManifestLine> shown;
    for (const FigureInput& input : lineage.inputs) {
      if (input.manifest != manifest.sha256) continue;
      for (const ManifestLine& line : input.lines) {
        const bool known = std::any_of(shown.begin(), shown.end(), [&](const ManifestLine& other) {
          return other.line == line.line;
        });
        if (!known) shown.push_back(line);
      }
    }
    std::sort(shown.begin(), shown.end(),
              [](const ManifestLine& a, const ManifestLine& b) { return a.line < b.line; });
    for (const ManifestLine& line : shown) {
      tell("  line {:>4}  {}\n", line.line, cut(line.text, 13));
    }
  }
}

void print_attempts(const RunLineage& stage, Machines& machines) {
  for (std::size_t a = 0; a < stage.attempts.size(); ++a) {
    const Attempt& attempt = stage.attempts[a];
    tell("  attempt {:<3} {}  {}, build {}, host {}\n", a + 1, moment(attempt.started_at),
         name_of(attempt.outcome), machines.build(attempt.host), machines.host(attempt.host));
    if (!attempt.why.empty()) tell("              {}\n", cut(attempt.why, 14));
    if (!attempt.from_checkpoint.empty()) {
      tell("  from        {}\n", attempt.from_checkpoint);
    }
  }
}

void print_checkpoints(const std::vector<std::string>& checkpoints, const RunLineage& run) {
  tell("  {:>6}  {:>2}  checkpoint\n", "cycle", "at");
  for (const std::string& sha256 : checkpoints) {
    const CheckpointHistory* known = run.find(sha256);
    if (known == nullptr) {
      tell("  {:>6}  {:>2}  {}\n", "?", "?", sha256);
      continue;
    }
    tell("  {:>6g}  {:>2}  {}\n", known->record.cycle,
         known->attempt ? std::to_string(*known->attempt + 1) : "?", sha256);
  }
}

void print_input(const FigureInput& input, const RunLineage& run, Machines& machines) {
  std::set<int> numbers;
  for (const ManifestLine& line : input.lines) numbers.insert(line.line);
  const std::string lines = numbers.empty() ? "?" : fmt::format("{}", fmt::join(numbers, ", "));
  tell("\nrun       {}\n", input.run);
  tell("  {}\n",
       cut(fmt::format("{} {}, seed {}, {} grains; manifest {:.8}, lines {}", input.experiment,
                       input.variant, input.seed, run.run.grains, input.manifest, lines),
           2));
  if (input.overrides.is_object()) {
    for (const auto& [key, values] : input.overrides.items()) {
      tell("  {}\n", cut(fmt::format("given at the command line: {} {} (manifest: {})", key,
                                     text_at(values, "run"), text_at(values, "manifest")),
                         2));
    }
  }
  print_attempts(run, machines);
  print_checkpoints(input.checkpoints, run);
}

void print_stage_before(const RunLineage& stage, Machines& machines) {
  tell("\nbefore    {}\n  {}, seed {}, {} grains\n", stage.run.id, cut(stage.run.kind, 50),
       text_at(stage.run.resolved, "seed"), stage.run.grains);
  print_attempts(stage, machines);
  std::vector<std::string> checkpoints;
  for (const CheckpointHistory& c : stage.checkpoints) {
    if (!c.rejected) checkpoints.push_back(c.record.sha256);
  }
  print_checkpoints(checkpoints, stage);
}

void print(const FigureLineage& lineage) {
  const nlohmann::json& facts = lineage.record.provenance;
  Machines machines;
  const nlohmann::json made = at(facts, "made");
  std::string by;
  if (made.is_object()) {
    by = fmt::format(", build {}, host {}", machines.build(made), machines.host(made));
  }
  const std::string scale = text_at(facts, "scale");
  tell("figure    {}, {} scale, analysis version {}\n", cut(lineage.record.name, 40),
       scale.empty() ? "base" : cut(scale, 50), text_at(facts, "analysis_version"));
  tell("made      {} UTC, event {}{}\n", moment(lineage.record.recorded_at), lineage.record.seq,
       by);
  for (const auto& [name, sha256] : lineage.outputs) {
    tell("  {:<12}{}\n", cut(name, 66), sha256);
  }
  print_manifests(lineage);
  for (const FigureInput& input : lineage.inputs) {
    print_input(input, lineage.runs.at(input.run), machines);
  }
  for (const auto& [id, stage] : lineage.runs) {
    const bool is_input = std::any_of(lineage.inputs.begin(), lineage.inputs.end(),
                                      [&id = id](const FigureInput& i) { return i.run == id; });
    if (is_input) continue;
    print_stage_before(stage, machines);
  }
  tell("\n");
  machines.print();
}

std::size_t checkpoints_of(const FigureLineage& lineage) {
  std::size_t count = 0;
  for (const FigureInput& input : lineage.inputs) count += input.checkpoints.size();
  return count;
}

nlohmann::json check_json(const std::filesystem::path& file, const PublishedFile& found,
                          const std::vector<InputFault>& faults, std::size_t inputs) {
  nlohmann::json list = nlohmann::json::array();
  for (const InputFault& fault : faults) {
    list.push_back({{"run", fault.run}, {"checkpoint", fault.checkpoint}, {"what", fault.what}});
  }
  const bool matches = found.verdict == PublishedFile::Verdict::matches;
  return {{"file", file.string()},
          {"sha256", found.sha256},
          {"recorded_sha256", found.recorded},
          {"verdict", matches ? "matches" : "changed"},
          {"inputs", inputs},
          {"input_faults", list}};
}

void print_check(const std::filesystem::path& file, const PublishedFile& found,
                 const std::vector<InputFault>& faults, std::size_t inputs) {
  tell("file      {}\n", cut(file.string(), 10));
  if (found.verdict == PublishedFile::Verdict::matches) {
    tell("verdict   matches what event {} recorded\n", found.record.seq);
  } else {
    tell("verdict   WAS CHANGED since event {}, or another store made it\n", found.record.seq);
    tell("  is      {}\n  was     {}\n", found.sha256, found.recorded);
  }
  if (faults.empty()) {
    tell("inputs    {} checkpoints, all present and right\n\n", inputs);
    return;
  }
  tell("inputs    {} checkpoints, {} of them not as they were\n", inputs, faults.size());
  for (const InputFault& fault : faults) tell("  {}\n  {}\n", fault.checkpoint, fault.what);
  tell("\n");
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
  // A checkpoint that was pruned on purpose is not damage.
  const bool damaged = std::any_of(faults.begin(), faults.end(),
                                   [](const InputFault& f) { return f.what != "pruned"; });
  if (damaged || found->verdict == PublishedFile::Verdict::changed) {
    context.exit_code = kStoreDamaged;
  }
  const std::size_t inputs = checkpoints_of(lineage);
  if (context.json) {
    nlohmann::json all = to_json(lineage);
    all["check"] = check_json(file, *found, faults, inputs);
    return print_json(all);
  }
  print_check(file, *found, faults, inputs);
  print(lineage);
}

}  // namespace shearcell::cli
