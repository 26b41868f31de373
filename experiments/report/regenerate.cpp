// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/regenerate.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fstream>
#include <mutex>
#include <set>
#include <thread>

#include "analysis/error.hpp"
#include "analysis/measures.hpp"
#include "analysis/plot.hpp"
#include "provenance/errors.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {
namespace {

struct ManifestFacts {
  std::string experiment;
  std::vector<std::string> figures;
};

std::vector<ManifestFacts> manifests(const Store& store) {
  std::vector<ManifestFacts> found;
  for (const Event& event : store.events()) {
    if (event.type != "ManifestRegistered") continue;
    const nlohmann::json body = event.body();
    const nlohmann::json& info = body.at("info");
    found.push_back({info.at("experiment").get<std::string>(),
                     info.at("figures").get<std::vector<std::string>>()});
  }
  return found;
}

bool asks_for(const ManifestFacts& manifest, std::string_view figure) {
  return std::find(manifest.figures.begin(), manifest.figures.end(), figure) !=
         manifest.figures.end();
}

// One run of the figure, with where it stands in an experiment and what to read.
struct Input {
  RunRecord run;
  Membership membership;
  std::vector<CheckpointRecord> checkpoints;  // at whole cycles
};

std::vector<Input> inputs_of(const Store& store, std::string_view figure,
                             const std::optional<std::string>& asked_scale, std::string& scale) {
  std::set<std::string> experiments;
  for (const ManifestFacts& manifest : manifests(store)) {
    if (asks_for(manifest, figure)) experiments.insert(manifest.experiment);
  }
  std::vector<Input> inputs;
  for (const RunRecord& run : store.runs()) {
    if (run.kind == "prepare") continue;
    for (const Membership& membership : run.memberships) {
      if (experiments.count(membership.experiment) == 0) continue;
      if (asked_scale && membership.scale != *asked_scale) continue;
      inputs.push_back({run, membership, {}});
    }
  }
  if (inputs.empty()) {
    throw NotFound("no run of the store belongs to figure " + std::string(figure) +
                   (asked_scale ? " at scale " + *asked_scale : "") +
                   "; run a manifest that lists it under `figures` first");
  }
  // Sizes are not mixed in one figure.
  scale = inputs.back().membership.scale;
  inputs.erase(std::remove_if(inputs.begin(), inputs.end(),
                              [&](const Input& i) { return i.membership.scale != scale; }),
               inputs.end());
  for (Input& input : inputs) {
    for (const CheckpointRecord& record : store.checkpoints(input.run.id, true)) {
      if (record.state == CheckpointState::rejected) continue;
      if (record.cycle == std::floor(record.cycle)) input.checkpoints.push_back(record);
    }
  }
  return inputs;
}

// Measures every checkpoint, several at a time; those that cannot be read stay empty.
class Measuring {
 public:
  Measuring(const Store& store, const std::vector<Input>& inputs, const RegenerateOptions& options)
      : store_(store), options_(options) {
    for (const Input& input : inputs) {
      for (const CheckpointRecord& record : input.checkpoints) work_.push_back(&record);
    }
    measured_.resize(work_.size());
  }

  std::vector<std::optional<Measures>> run(RegeneratedFigure& result) {
    std::vector<std::thread> threads;
    for (std::size_t w = 0; w < std::max<std::size_t>(1, options_.workers); ++w) {
      threads.emplace_back([this] { measure_some(); });
    }
    for (std::thread& thread : threads) thread.join();
    if (error_) std::rethrow_exception(error_);
    std::sort(damage_.begin(), damage_.end());
    std::sort(pruned_.begin(), pruned_.end());
    result.damage = damage_;
    result.pruned = pruned_;
    return std::move(measured_);
  }

 private:
  void measure_some() {
    for (std::size_t i = next_++; i < work_.size(); i = next_++) {
      try {
        measured_[i] = measure(store_.load_checkpoint(*work_[i]));
      } catch (const StoreDamaged& error) {
        const std::lock_guard lock(mutex_);
        damage_.push_back(error.what());
      } catch (const CheckpointPruned& error) {
        const std::lock_guard lock(mutex_);
        pruned_.push_back(error.what());
      } catch (...) {
        const std::lock_guard lock(mutex_);
        if (!error_) error_ = std::current_exception();
        return;
      }
      const std::lock_guard lock(mutex_);
      if (options_.report) options_.report(++done_, work_.size());
    }
  }

  const Store& store_;
  const RegenerateOptions& options_;
  std::vector<const CheckpointRecord*> work_;
  std::vector<std::optional<Measures>> measured_;
  std::atomic<std::size_t> next_{0};
  std::mutex mutex_;  // guards what follows
  std::size_t done_ = 0;
  std::vector<std::string> damage_, pruned_;
  std::exception_ptr error_;
};

std::vector<FigureRun> figure_runs(const std::vector<Input>& inputs,
                                   const std::vector<std::optional<Measures>>& measured) {
  std::vector<FigureRun> runs;
  std::size_t next = 0;
  for (const Input& input : inputs) {
    FigureRun run{
        input.run.id, input.membership.variant, input.membership.labels, input.membership.seed, {}};
    for (const CheckpointRecord& record : input.checkpoints) {
      const std::optional<Measures>& measures = measured[next++];
      if (measures)
        run.checkpoints.push_back({record.cycle, record.step, record.sha256, *measures});
    }
    runs.push_back(std::move(run));
  }
  return runs;
}

std::string file_sha256(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  return sha256_hex(bytes);
}

// What the figure came from, in terms that do not change when it is made again.
nlohmann::json lineage(const RegeneratedFigure& result, const std::vector<Input>& inputs,
                       const std::vector<FigureRun>& runs) {
  nlohmann::json list = nlohmann::json::array();
  for (std::size_t r = 0; r < runs.size(); ++r) {
    nlohmann::json checkpoints = nlohmann::json::array();
    for (const CheckpointMeasures& c : runs[r].checkpoints) checkpoints.push_back(c.sha256);
    list.push_back({{"run", runs[r].run_id},
                    {"parent", inputs[r].run.parent},
                    {"experiment", inputs[r].membership.experiment},
                    {"manifest", inputs[r].membership.manifest},
                    {"variant", runs[r].variant},
                    {"seed", runs[r].seed},
                    {"checkpoints", checkpoints}});
  }
  nlohmann::json outputs = nlohmann::json::object();
  for (const auto& file : result.files) outputs[file.filename().string()] = file_sha256(file);
  return {{"figure", result.name}, {"scale", result.scale}, {"inputs", list}, {"outputs", outputs}};
}

}  // namespace

std::vector<std::string> figures_of_store(const Store& store) {
  const std::vector<ManifestFacts> registered = manifests(store);
  std::vector<std::string> names;
  for (const Figure& figure : all_figures()) {
    const bool asked =
        std::any_of(registered.begin(), registered.end(),
                    [&](const ManifestFacts& manifest) { return asks_for(manifest, figure.name); });
    if (asked) names.emplace_back(figure.name);
  }
  return names;
}

RegeneratedFigure regenerate(Store& store, const Figure& figure, const RegenerateOptions& options) {
  RegeneratedFigure result;
  result.name = figure.name;
  const std::vector<Input> inputs = inputs_of(store, figure.name, options.scale, result.scale);
  const auto measured = Measuring(store, inputs, options).run(result);
  const std::vector<FigureRun> runs = figure_runs(inputs, measured);
  result.runs = runs.size();
  for (const FigureRun& run : runs) result.checkpoints += run.checkpoints.size();

  std::filesystem::create_directories(options.folder);
  for (const FigureTable& table : figure.make(runs)) {
    result.files.push_back(write_csv(table, options.folder));
    try {
      result.files.push_back(draw_svg(table, options.folder));
    } catch (const AnalysisError& error) {
      result.plot_error = error.what();
    }
  }
  const nlohmann::json facts = lineage(result, inputs, runs);
  const auto path = options.folder / (result.name + ".lineage.json");
  std::ofstream file(path);
  file << facts.dump(1) << '\n';
  if (!file.flush()) throw std::runtime_error(path.string() + ": cannot write the lineage");
  result.files.push_back(path);

  bool recorded = false;
  for (const FigureRecord& known : store.figures()) {
    recorded = recorded || (known.name == result.name && known.provenance == facts);
  }
  if (!recorded) store.record_figure(result.name, facts);
  return result;
}

}  // namespace shearcell
