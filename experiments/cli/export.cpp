// SPDX-License-Identifier: GPL-3.0-or-later
// `export`: writes runs in the formats of other programs.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "core/drive.hpp"
#include "experiments/cli/command.hpp"
#include "experiments/export/formats.hpp"
#include "experiments/manifest/identity.hpp"
#include "experiments/runner/outlook.hpp"
#include "provenance/errors.hpp"
#include "provenance/io/file.hpp"
#include "provenance/io/read_number.hpp"
#include "provenance/ro_crate.hpp"
#include "provenance/words.hpp"

namespace shearcell::cli {
namespace {

namespace fs = std::filesystem;

struct ExportOptions {
  std::vector<std::string> runs;
  RunSelection selection;
  std::string format;
  std::string out;
  std::string licence;
  std::string cycles;  ///< "A", "A:B" or "A:B:STEP", each part may be empty; "" for all
  bool metres = false;
};

struct ExportFormat {
  const char* name;
  const char* title;
  const char* ending;  ///< of the file's name; "" for a folder
  /// Makes a writer of this number of frames to `out`; null for a crate, which has no frames.
  FrameWriter (*writer)(const fs::path& out, std::size_t frames, LengthUnit unit);
};

bool is_folder(const ExportFormat& format) {
  return *format.ending == '\0';
}

// A new format is one entry here.
const std::array kFormats = {
    ExportFormat{"h5md", "H5MD 1.1, one file: MDAnalysis, h5py, VMD; lengths in nm", ".h5md",
                 [](const auto& out, auto frames, auto) { return h5md_writer(out, frames); }},
    ExportFormat{"extxyz", "extended XYZ, one file: OVITO, ASE, MDAnalysis; lengths in d", ".xyz",
                 [](const auto& out, auto, auto unit) { return extxyz_writer(out, unit); }},
    ExportFormat{"vtk", "VTK PolyData and run.json, a folder: ParaView; SI", "",
                 [](const auto& out, auto frames, auto) { return vtk_writer(out, frames); }},
    ExportFormat{"lammps", "LAMMPS data with a script to continue, a folder: LAMMPS, OVITO; SI", "",
                 [](const auto& out, auto, auto) { return lammps_writer(out); }},
    ExportFormat{"contacts", "pairs with overlap and force, CSV and run.json, a folder: pandas", "",
                 [](const auto& out, auto, auto) { return contacts_writer(out); }},
    ExportFormat{"ro-crate", "RO-Crate 1.1 with Process Run Crate 0.5", "", nullptr},
};

struct CycleRange {
  double first = 0;
  double last = std::numeric_limits<double>::infinity();
  double every = 0;  ///< 0: all checkpoints

  /// `near` is half a time step [cycles], so that 3.3 selects the nearest step.
  bool holds(double cycle, double near) const {
    return cycle >= first - near && cycle <= last + near &&
           (every == 0 || std::abs(std::remainder(cycle - first, every)) <= near);
  }
};

/// Reads --cycles. Throws std::invalid_argument.
CycleRange parse_cycles(const std::string& text) {
  CycleRange range;
  std::istringstream parts(text);
  double* const values[] = {&range.first, &range.last, &range.every};
  std::size_t k = 0;
  for (std::string part; std::getline(parts, part, ':'); ++k) {
    if (part.empty() && k < 3) continue;
    const auto value = read_number<double>(part);
    const bool fits = value && std::isfinite(*value) && *value >= (k == 2 ? 1e-9 : 0);
    if (k >= 3 || !fits) {
      throw std::invalid_argument(
          "--cycles takes A, A:B or A:B:STEP, such as 1.25, 0:60 or ::10 (got " + text + ")");
    }
    *values[k] = *value;
    if (range.last < range.first) {
      throw std::invalid_argument(fmt::format(
          "--cycles {}: the first cycle is after the last; write {}:{}", text, part, range.first));
    }
  }
  if (k == 1 && text.find(':') == std::string::npos) range.last = range.first;
  return range;
}

// For a run selected by its id: what any experiment asks of it. Else: what the selected experiments
// ask of it.
std::vector<Ask> asks_of(const PlacedRun& run) {
  return asks_of(run.places.empty() ? run.stage.memberships : run.places);
}

std::vector<CheckpointRecord> chosen(const Store& store, const PlacedRun& wanted,
                                     const ExportOptions& options) {
  const Stage& stage = wanted.stage;
  const std::string& cycles = options.cycles;
  const CycleRange range = parse_cycles(cycles);
  const std::optional<Drive> motion = shear_drive(stage);
  const double near = motion ? 0.5 / static_cast<double>(cycle_steps(*motion)) : 0;
  std::vector<CheckpointRecord> records;
  std::size_t pruned = 0;
  // A single cycle may also be a checkpoint that an interruption left.
  const bool by_name = range.first == range.last;
  std::vector<CheckpointRecord> all = store.checkpoints(stage.id, Listed::and_pruned);
  if (!by_name) {
    all = wanted.places.empty() ? asked_checkpoints(stage, asks_of(wanted), all).made
                                : checkpoints_for(store, stage, asks_of(wanted));
  }
  for (const CheckpointRecord& record : all) {
    if (!range.holds(record.cycle, near)) continue;
    if (record.state == CheckpointState::pruned) ++pruned;
    if (record.state == CheckpointState::recorded) records.push_back(record);
  }
  if (records.empty()) {
    if (all.empty()) {
      throw std::invalid_argument(fmt::format("run {:.8} has no checkpoint yet", stage.id));
    }
    throw std::invalid_argument(fmt::format(
        "run {:.8} has no stored checkpoint{}{}; {}", stage.id, cycles.empty() ? "" : " in cycles ",
        cycles,
        pruned > 0 ? "`shearcell regenerate` recomputes the pruned ones"
                   : fmt::format("it has cycles {} to {}", all.front().cycle, all.back().cycle)));
  }
  if (pruned > 0) {
    print_stderr("run {:.8}: left out: {} (pruned; `shearcell regenerate` recomputes them)\n",
                 stage.id, counted(pruned, "checkpoint"));
  }
  return records;
}

/// Throws unless `out` does not exist, or is an empty folder where a folder will be written.
void require_new(const fs::path& out, bool folder) {
  const bool usable = folder && fs::is_directory(out) && fs::is_empty(out);
  if (fs::exists(fs::symlink_status(out)) && !usable) {
    throw std::invalid_argument(out.string() + " exists already. Name a new one.");
  }
}

/// The names of the files in the folder `out`, or the name of the file `out`.
std::vector<std::string> files_of(const fs::path& out) {
  std::vector<std::string> files;
  if (!fs::is_directory(out)) return {out.filename().string()};
  for (const auto& entry : fs::directory_iterator(out)) {
    files.push_back(entry.path().filename().string());
  }
  std::ranges::sort(files);
  return files;
}

/// A crate states the parameters that the runs had, as `show` prints them.
CrateFacts crate_of(const Store& store, const std::string& run, const std::string& licence) {
  CrateFacts facts = crate_facts(store, run);
  facts.licence = licence;
  for (RunLineage& stage : facts.stages) {
    nlohmann::json& resolved = stage.stage.resolved;
    if (resolved.is_object()) resolved["parameters"] = effective_parameters(resolved);
  }
  return facts;
}

/// The place after which the exported file of the run is named.
Place shown_place(const PlacedRun& run) {
  return run.places.empty() ? first_place(run.stage) : run.places.front().place;
}

/// Writes these checkpoints to `out`, or the whole run if the format is a crate. Returns the names
/// of the files.
std::vector<std::string> write_records(const Store& store, const PlacedRun& run,
                                       const std::vector<CheckpointRecord>& records,
                                       const ExportFormat& format, const ExportOptions& options,
                                       const fs::path& out, MeasureOutcome& unread) {
  if (format.writer == nullptr) {
    return write_ro_crate(store, crate_of(store, run.stage.id, options.licence), out);
  }
  const bool folder = is_folder(format);
  if (folder) fs::create_directory(out);
  const LengthUnit unit = options.metres ? LengthUnit::m : LengthUnit::d;
  std::vector<FrameWriter> writers = {format.writer(out, records.size(), unit)};
  if (folder) writers.push_back(facts_writer(out, records.size()));
  const std::uint64_t every = checkpoint_cadence(asks_of(run));
  MeasureSources sources(store);
  sources.read_run(run.stage.id);
  for (const CheckpointRecord& record : records) {
    const ExportedState frame = frame_of(store.load_checkpoint(record), record,
                                         {shown_place(run), {}, run.stage}, &sources, every);
    unread += frame.unread;
    for (const FrameWriter& write : writers) write(frame);
  }
  writers.clear();  // closes the files
  return files_of(out);
}

/// Writes the run to `out`, which does not exist or holds an earlier crate of the run, and returns
/// the names of the files. Measures that are NaN because an earlier checkpoint cannot be read have
/// a line in `unread`. Throws std::invalid_argument if the run cannot be exported, and FilePruned
/// if a pruned checkpoint decides where the run ends.
std::vector<std::string> write_run(const Store& store, const PlacedRun& run,
                                   const ExportFormat& format, const ExportOptions& options,
                                   const fs::path& out, MeasureOutcome& unread) {
  for (;;) {
    std::vector<CheckpointRecord> records;
    if (format.writer != nullptr) records = chosen(store, run, options);
    try {
      return write_records(store, run, records, format, options, out, unread);
    } catch (const FilePruned&) {
      // Another program pruned a chosen checkpoint, which is not chosen again.
      if (!fs::exists(out / kCrateMetadata)) fs::remove_all(out);
    }
  }
}

// Readers of an RO-Crate take a text that is no web address for the name of a file in the crate.
std::string check_uri(const std::string& text) {
  const bool web = text.starts_with("https://") || text.starts_with("http://");
  return web && text.find_first_of(" \"<>\\") == std::string::npos
             ? ""
             : text + " is not an https:// URI";
}

/// Throws if an option has no effect on this format.
void require_effect(const ExportOptions& options, const ExportFormat& format) {
  const bool crate = format.writer == nullptr;
  const auto refuse = [&](const char* option) {
    throw CLI::ValidationError(option, fmt::format("has no effect with --to {}", format.name));
  };
  if (crate && !options.cycles.empty()) refuse("--cycles");
  if (!crate && !options.licence.empty()) refuse("--license");
  if (options.metres && options.format != "extxyz") refuse("--metres");
}

/// The named runs, or else the selected newest_runs(), each once.
std::vector<PlacedRun> wanted_runs(const Store& store, const ExportOptions& options) {
  parse_cycles(options.cycles);  // throws here once, not for each run
  std::vector<PlacedRun> runs;
  for (const std::string& prefix : options.runs) {
    Stage stage = store.find_stage(prefix);
    const auto is_it = [&](const PlacedRun& other) { return other.stage.id == stage.id; };
    if (std::ranges::none_of(runs, is_it)) runs.push_back({std::move(stage), {}});
  }
  if (!runs.empty()) return runs;
  const NewestRuns newest = newest_runs(select_runs(store, options.selection));
  for (const std::string& note : newest.notes) print_stderr("{}\n", note);
  runs = by_run(newest.runs);
  if (runs.empty()) throw std::invalid_argument("no run of the store is selected");
  return runs;
}

/// The name of a run's file in a folder of several: "drag_fluid=still_seed1_3f9a52c1.xyz".
std::string entry_name(const PlacedRun& run, const ExportFormat& format) {
  const Place place = shown_place(run);
  std::string name =
      fmt::format("{}_{}_seed{}_{:.8}{}", place.experiment.substr(0, 64),
                  place.variant.substr(0, 100), place.seed, run.stage.id, format.ending);
  std::ranges::replace_if(
      name,
      [](unsigned char c) {
        return std::isalnum(c) == 0 &&
               std::string("=.+-").find(static_cast<char>(c)) == std::string::npos;
      },
      '_');
  return name;
}

struct Exported {
  std::string run;  ///< its id
  fs::path out;     ///< PATH as given, or a file or folder in it
  std::vector<std::string> files;
};

/// Writes a `single` run to `out`, several runs into the folder `out`. Writes into a temporary
/// folder beside `out` and renames it when complete, so an export that is killed or meets a full
/// disk leaves no `out`.
std::vector<Exported> write_all(const Store& store, const std::vector<PlacedRun>& runs,
                                const ExportFormat& format, const ExportOptions& options,
                                bool single, MeasureOutcome& unread) {
  // "frames/" has an empty file name.
  const fs::path given = fs::absolute(options.out);
  const fs::path out = given.has_filename() ? given : given.parent_path();
  // A crate may replace an earlier one of the run.
  if (single && format.writer == nullptr && fs::exists(out) && !fs::is_empty(out)) {
    return {{runs.front().stage.id, options.out,
             write_run(store, runs.front(), format, options, out, unread)}};
  }
  const bool folder = !single || is_folder(format), stream = is_stream(options.out);
  if (folder && stream) throw std::invalid_argument("--out: " + unfit_folder("-"));
  if (!stream) require_new(out, folder);
  if (!stream) fs::create_directories(out.parent_path());
  const TemporaryFolder stage(
      stream ? ".shearcell.tmp-"
             : (out.parent_path() / ("." + out.filename().string() + ".tmp-")).string());
  const fs::path staged = stage.path() / out.filename();
  std::vector<Exported> done;
  if (!single) fs::create_directory(staged);
  for (const PlacedRun& run : runs) {
    const std::string name = single ? "" : entry_name(run, format);
    try {
      auto files = write_run(store, run, format, options, single ? staged : staged / name, unread);
      done.push_back({run.stage.id, single ? fs::path(options.out) : out / name, std::move(files)});
    } catch (const std::invalid_argument& problem) {  // no checkpoint in these cycles
      if (single || (&run == &runs.back() && done.empty())) throw;
      print_stderr("left out: {}\n", problem.what());
    }
  }
  if (stream) {
    write_result(options.out, read_plain(staged, SIZE_MAX - 1).value());
    return done;
  }
  require_new(out, folder);
  fs::rename(staged, out);
  return done;
}

void export_runs(const ExportOptions& options, Context& context) {
  const Store store(context.store, Access::read);
  const ExportFormat& format = *std::ranges::find(kFormats, options.format, &ExportFormat::name);
  require_effect(options, format);
  std::vector<Exported> done;
  bool single = false;
  MeasureOutcome unread;
  try {
    const std::vector<PlacedRun> runs = wanted_runs(store, options);
    single = !options.runs.empty() && runs.size() == 1;
    done = write_all(store, runs, format, options, single, unread);
  } catch (const std::invalid_argument& problem) {
    throw UsageError(problem.what());
  }
  print_problems(unread, "not measured", context);
  if (is_stream(options.out)) return;
  if (context.json) {
    const nlohmann::json list = list_of(done, [&](const Exported& one) -> nlohmann::json {
      return {{"run", one.run},
              {"format", options.format},
              {"out", one.out.string()},
              {"files", one.files}};
    });
    return print_json(single ? list.front() : list);
  }
  for (const Exported& one : done) {
    print_text("run {:.12}: {} in {}\n", one.run, counted(one.files.size(), "file"),
               one.out.string());
  }
}

}  // namespace

void add_export(CLI::App& app, Context& context) {
  const auto [command, options] = add_command(
      app, context, "export", "Write runs in the formats of other programs", export_runs);
  CLI::Option* named = command->add_option(
      "run", options->runs, "Run ids, or unique beginnings of them (default: all selected)");
  add_selection_options(*command, options->selection);
  for (const char* filter : {"--experiment", "--scale", "--variant", "--seed"}) {
    named->excludes(command->get_option(filter));
  }
  std::vector<std::string> names;
  std::string formats = "Formats:\n";
  for (const ExportFormat& format : kFormats) {
    names.emplace_back(format.name);
    formats += fmt::format("  {:<10} {}\n", format.name, format.title);
  }
  command->add_option("--to", options->format, "Format")->required()->check(CLI::IsMember(names));
  command->add_option("--out", options->out, "File (- is standard output) or folder to write")
      ->required()
      ->check(unfit_output)
      ->type_name("PATH");
  command
      ->add_option(
          "--cycles", options->cycles,
          "Checkpoints of these cycles (default: all that were asked for; not with ro-crate)")
      ->type_name("A[:B[:STEP]]");
  command->add_flag("--metres", options->metres, "Extended XYZ in SI units, not in diameters");
  command->add_option("--license", options->licence, "URI of the licence of the data")
      ->type_name("URI")
      ->check(check_uri);
  add_common_options(
      *command, context,
      formats +
          R"(Each file holds its run, seed, parameters and units, every scalar measure of each frame, and for
each grain id, radius, velocity, phi_local, q6, largest overlap, contacts, pressure, structure (by q6),
lattice (by common neighbours), crystallite, and displacement and D^2_min over the cycle before, with
wall grains and the tilted cell. A single RUN is written to PATH. Several runs, and runs that options
select, are written into the folder PATH, each under its own name. PATH must be new, but a crate may
replace an earlier crate of the same run. With --to lammps, `lmp -in in.frame_CYCLE` in that folder
continues the run from that checkpoint.
Examples:
  shearcell export 3f9a --to extxyz --cycles 0:60:10 --out run.xyz
  shearcell export 3f9a --to vtk --out frames
  shearcell export --experiment drag --variant fluid=cell --to extxyz --out packings
  shearcell export 3f9a --to ro-crate --out crate)");
}

}  // namespace shearcell::cli
