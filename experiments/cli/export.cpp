// SPDX-License-Identifier: GPL-3.0-or-later
// `export`: writes runs in the file formats of other programs.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <filesystem>
#include <iterator>
#include <limits>
#include <sstream>
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
  std::string cycles;  ///< "A", "A:B" or "A:B:STEP"; parts may be empty; "" selects all cycles
  bool metres = false;
};

struct ExportFormat {
  const char* name;
  const char* title;
  const char* ending;  ///< extension of the file name; "" if the format is a folder
  /// Returns a function that writes `frames` frames to `out`. `writer` is null for an RO-Crate,
  /// which has no frames.
  FrameWriter (*writer)(const fs::path& out, std::size_t frames, LengthUnit unit);
};

bool is_folder(const ExportFormat& format) {
  return *format.ending == '\0';
}

const std::array kFormats = {
    ExportFormat{"h5md", "H5MD 1.1, one file for MDAnalysis, h5py and VMD; lengths in nm", ".h5md",
                 [](const auto& out, auto frames, auto) { return h5md_writer(out, frames); }},
    ExportFormat{"extxyz",
                 "extended XYZ, one file for OVITO, ASE, MDAnalysis; lengths in diameters", ".xyz",
                 [](const auto& out, auto, auto unit) { return extxyz_writer(out, unit); }},
    ExportFormat{"vtk", "a folder for ParaView: VTK PolyData files and run.json; SI units", "",
                 [](const auto& out, auto frames, auto) { return vtk_writer(out, frames); }},
    ExportFormat{"lammps", "a folder for LAMMPS and OVITO: data files and scripts; SI units", "",
                 [](const auto& out, auto, auto) { return lammps_writer(out); }},
    ExportFormat{"contacts", "a folder for pandas: overlaps and forces as CSV files, and run.json",
                 "", [](const auto& out, auto, auto) { return contacts_writer(out); }},
    ExportFormat{"ro-crate", "RO-Crate 1.1 with Process Run Crate 0.5", "", nullptr},
};

struct CycleRange {
  double first = 0;
  double last = std::numeric_limits<double>::infinity();
  double every = 0;  ///< step [cycles]; 0 selects all checkpoints

  /// Whether `cycle` is within `near` of a selected cycle. `near`: half a time step [cycles]. For
  /// example, --cycles 3.3 selects the checkpoint at the time step nearest to cycle 3.3.
  bool holds(double cycle, double near) const {
    return cycle >= first - near && cycle <= last + near &&
           (every == 0 || std::abs(std::remainder(cycle - first, every)) <= near);
  }
};

/// Reads the value of --cycles. Throws UsageError if it is invalid.
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
      throw UsageError("--cycles needs A, A:B or A:B:STEP, such as 1.25, 0:60 or ::10 (got " +
                       text + ")");
    }
    *values[k] = *value;
  }
  if (range.last < range.first) {
    throw UsageError(fmt::format("--cycles {}: the first cycle is after the last", text));
  }
  if (k == 1 && text.find(':') == std::string::npos) range.last = range.first;
  return range;
}

/// The run has no stored checkpoint in the selected cycles.
struct NothingToExport : UsageError {
  using UsageError::UsageError;
};

void say_pruned(const Stage& stage, std::size_t pruned) {
  if (pruned == 0) return;
  print_stderr("run {:.8}: left out: {} (pruned; `shearcell regenerate` recomputes them)\n",
               stage.id, counted(pruned, "checkpoint"));
}

std::vector<CheckpointRecord> chosen(const Store& store, const PlacedRun& run,
                                     const std::string& cycles) {
  const Stage& stage = run.stage;
  const CycleRange range = parse_cycles(cycles);
  const std::optional<Drive> motion = shear_drive(stage);
  const double near = motion ? 0.5 / static_cast<double>(cycle_steps(*motion)) : 0;
  // If one cycle is requested, also considers checkpoints that only an interruption caused.
  const std::vector<CheckpointRecord> all =
      range.first == range.last ? store.checkpoints(stage.id, Listed::and_pruned)
                                : checkpoints_for(store, stage, asks_of(run.places));
  if (all.empty()) {
    throw NothingToExport(fmt::format("run {:.8} has no checkpoint yet", stage.id));
  }
  std::vector<CheckpointRecord> records;
  std::ranges::copy_if(all, std::back_inserter(records), [&](const CheckpointRecord& record) {
    return range.holds(record.cycle, near);
  });
  const std::size_t pruned = std::erase_if(records, [](const CheckpointRecord& record) {
    return record.state == CheckpointState::pruned;
  });
  if (records.empty()) {
    throw NothingToExport(
        fmt::format("run {:.8} has no stored checkpoint{}{}; {}", stage.id,
                    cycles.empty() ? "" : " in cycles ", cycles,
                    pruned > 0 ? "`shearcell regenerate` recomputes the pruned checkpoints"
                               : fmt::format("the run has checkpoints of cycles {} to {}",
                                             all.front().cycle, all.back().cycle)));
  }
  say_pruned(stage, pruned);
  return records;
}

/// Throws UsageError if `out` exists. An empty folder is allowed if `folder` is true.
void require_new(const fs::path& out, bool folder) {
  const bool usable = folder && fs::is_directory(out) && fs::is_empty(out);
  if (fs::exists(fs::symlink_status(out)) && !usable) {
    throw UsageError(out.string() + " already exists. Choose another path.");
  }
}

std::vector<std::string> files_of(const fs::path& out) {
  std::vector<std::string> files;
  if (!fs::is_directory(out)) return {out.filename().string()};
  for (const auto& entry : fs::directory_iterator(out)) {
    files.push_back(entry.path().filename().string());
  }
  std::ranges::sort(files);
  return files;
}

/// Returns the contents of a crate. As in `show`, only parameters that affect the runs are listed.
CrateFacts crate_of(const Store& store, const std::string& run, const std::string& licence) {
  CrateFacts facts = crate_facts(store, run);
  facts.licence = licence;
  for (RunLineage& stage : facts.stages) {
    nlohmann::json& resolved = stage.stage.resolved;
    if (resolved.is_object()) resolved["parameters"] = effective_parameters(resolved);
  }
  return facts;
}

/// Returns the place (experiment, variant and seed) that gives the exported file its name.
Place shown_place(const PlacedRun& run) {
  return run.places.empty() ? Place{} : run.places.front().place;
}

std::vector<std::string> write_records(const Store& store, const PlacedRun& run,
                                       const std::vector<CheckpointRecord>& records,
                                       const ExportFormat& format, const ExportOptions& options,
                                       const fs::path& out, MeasureOutcome& unread) {
  if (format.writer == nullptr) {
    const std::vector<CheckpointRecord> all = store.checkpoints(run.stage.id, Listed::and_pruned);
    say_pruned(run.stage, static_cast<std::size_t>(std::ranges::count(all, CheckpointState::pruned,
                                                                      &CheckpointRecord::state)));
    return write_ro_crate(store, crate_of(store, run.stage.id, options.licence), out);
  }
  const bool folder = is_folder(format);
  if (folder) fs::create_directory(out);
  const LengthUnit unit = options.metres ? LengthUnit::m : LengthUnit::d;
  std::vector<FrameWriter> writers = {format.writer(out, records.size(), unit)};
  if (folder) writers.push_back(facts_writer(out, records.size()));
  const std::uint64_t every = checkpoint_cadence(asks_of(run.places));
  MeasureSources sources(store);
  sources.read_run(run.stage.id);
  for (const CheckpointRecord& record : records) {
    const ExportedState frame = frame_of(store.load_checkpoint(record), record,
                                         {shown_place(run), {}, run.stage}, sources, every);
    unread += frame.unread;
    for (const FrameWriter& write : writers) write(frame);
  }
  writers.clear();  // closes the files
  return files_of(out);
}

/// Writes the run to `out` and returns the names of the files. `out` must not exist, unless it is
/// an earlier crate of the run. A measure that needs an unreadable earlier checkpoint is NaN, and
/// `unread` reports that checkpoint. Throws NothingToExport if no checkpoint of
/// the selected cycles is stored. Throws FilePruned if the end of the run cannot be determined
/// without a pruned checkpoint.
std::vector<std::string> write_run(const Store& store, const PlacedRun& run,
                                   const ExportFormat& format, const ExportOptions& options,
                                   const fs::path& out, MeasureOutcome& unread) {
  for (;;) {
    std::vector<CheckpointRecord> records;
    if (format.writer != nullptr) records = chosen(store, run, options.cycles);
    try {
      return write_records(store, run, records, format, options, out, unread);
    } catch (const FilePruned&) {
      // Another program has just pruned a chosen checkpoint. Retries without this checkpoint.
      if (!fs::exists(out / kCrateMetadata)) fs::remove_all(out);
    }
  }
}

// Returns an error message if the text is not a web address, else "". Programs that read an
// RO-Crate treat any other text as the name of a file in the crate.
std::string check_uri(const std::string& text) {
  const bool web = text.starts_with("https://") || text.starts_with("http://");
  return web && text.find_first_of(" \"<>\\") == std::string::npos
             ? ""
             : text + " is not an https:// URI";
}

void require_effect(const ExportOptions& options, const ExportFormat& format) {
  const bool crate = format.writer == nullptr;
  const auto refuse = [&](const char* option) {
    throw CLI::ValidationError(option, fmt::format("has no effect with --to {}", format.name));
  };
  if (crate && !options.cycles.empty()) refuse("--cycles");
  if (!crate && !options.licence.empty()) refuse("--license");
  if (options.metres && options.format != "extxyz") refuse("--metres");
}

/// Returns the runs that the user named, each with all its places (see PlacedRun). If the user
/// named no run, returns newest_runs() of the selection. Each run occurs once.
std::vector<PlacedRun> wanted_runs(const Store& store, const ExportOptions& options) {
  parse_cycles(options.cycles);  // throws once here, instead of once for each run
  std::vector<PlacedRun> runs;
  for (const std::string& prefix : options.runs) {
    Stage stage = store.find_stage(prefix);
    const auto is_it = [&](const PlacedRun& other) { return other.stage.id == stage.id; };
    if (std::ranges::none_of(runs, is_it)) runs.push_back({stage, stage.memberships});
  }
  if (!runs.empty()) return runs;
  const NewestRuns newest = newest_runs(select_runs(store, options.selection));
  for (const std::string& note : newest.notes) print_stderr("{}\n", note);
  runs = by_run(newest.runs);
  if (runs.empty()) throw UsageError("no run of the store is selected");
  return runs;
}

/// Name of a run's file or folder in the folder given with --out, such as
/// "drag_fluid=still_seed1_3f9a52c1.xyz".
std::string entry_name(const PlacedRun& run, const ExportFormat& format) {
  const Place place = shown_place(run);
  std::string name =
      fmt::format("{}_{}_seed{}_{:.8}{}", place.experiment.substr(0, 64),
                  place.variant.substr(0, 100), place.seed, run.stage.id, format.ending);
  const auto is_unfit = [](unsigned char c) {
    return std::isalnum(c) == 0 &&
           std::string_view("=.+-").find(static_cast<char>(c)) == std::string_view::npos;
  };
  std::ranges::replace_if(name, is_unfit, '_');
  return name;
}

struct Exported {
  std::string run;  ///< id of the run
  fs::path out;     ///< where the run was written: the path given with --out, or a path in it
  std::vector<std::string> files;
};

/// Writes one run to PATH if `single` is true, else all runs into the folder PATH. Writes into a
/// temporary folder first and moves the complete result to PATH. An export that is killed or fills
/// the disk thus leaves nothing at PATH. Of several runs, leaves out and names those that are
/// damaged or have nothing to export; throws if no run is left.
std::vector<Exported> write_all(const Store& store, const std::vector<PlacedRun>& runs,
                                const ExportFormat& format, const ExportOptions& options,
                                bool single, MeasureOutcome& unread, Context& context) {
  // A path such as "frames/" has an empty file name.
  const fs::path given = fs::absolute(options.out);
  const fs::path out = given.has_filename() ? given : given.parent_path();
  // An RO-Crate may replace an earlier RO-Crate of the same run.
  if (single && format.writer == nullptr && fs::exists(out) && !fs::is_empty(out)) {
    return {{runs.front().stage.id, options.out,
             write_run(store, runs.front(), format, options, out, unread)}};
  }
  const bool folder = !single || is_folder(format), stream = is_stream(options.out);
  if (folder && stream) throw UsageError("--out: " + unfit_folder("-"));
  if (!stream) require_new(out, folder);
  if (!stream) fs::create_directories(out.parent_path());
  const TemporaryFolder stage(
      stream ? ".shearcell.tmp-"
             : (out.parent_path() / ("." + out.filename().string() + ".tmp-")).string());
  const fs::path staged = stage.path() / out.filename();
  std::vector<Exported> done;
  std::exception_ptr left_out;  // why a run was left out; a damaged one if there is any
  if (!single) fs::create_directory(staged);
  for (const PlacedRun& run : runs) {
    const std::string name = single ? "" : entry_name(run, format);
    const fs::path path = single ? staged : staged / name;
    try {
      auto files = write_run(store, run, format, options, path, unread);
      done.push_back({run.stage.id, single ? fs::path(options.out) : out / name, std::move(files)});
    } catch (const NothingToExport& problem) {
      if (!single) print_stderr("left out: {}\n", problem.what());
      if (!left_out) left_out = std::current_exception();
    } catch (const StoreDamaged& damage) {
      if (!single) print_stderr("left out: run {:.8}: {}\n", run.stage.id, damage.what());
      left_out = std::current_exception();
      fs::remove_all(path);
      fail(context, kStoreDamaged);
    }
  }
  if (done.empty()) std::rethrow_exception(left_out);
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
  MeasureOutcome unread;
  const std::vector<PlacedRun> runs = wanted_runs(store, options);
  const bool single = !options.runs.empty() && runs.size() == 1;
  const std::vector<Exported> done =
      write_all(store, runs, format, options, single, unread, context);
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
      "run", options->runs, "Run ids, or unique beginnings of run ids (default: selected runs)");
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
  command->add_option("--out", options->out, "File or folder to write; - is standard output")
      ->required()
      ->check(unfit_output)
      ->type_name("PATH");
  command
      ->add_option(
          "--cycles", options->cycles,
          "Only checkpoints of these cycles. Default: all that the experiments request. Not "
          "possible with --to ro-crate")
      ->type_name("A[:B[:STEP]]");
  command->add_flag("--metres", options->metres, "Extended XYZ in SI units, not in diameters");
  command->add_option("--license", options->licence, "URI of the licence of the data")
      ->type_name("URI")
      ->check(check_uri);
  add_common_options(
      *command, context,
      formats +
          R"(Each file contains the run, seed, parameters and units, the wall grains, the tilted cell, and all
scalar measures of each frame. For each grain it contains id, radius, velocity, phi_local, q6,
largest overlap, number of contacts, pressure, structure (from q6), lattice (from common
neighbours), crystallite, and the displacement and D^2_min since one cycle earlier.
A single RUN is written to PATH. Several runs, and runs selected by options, are written into the
folder PATH, each under a different name. PATH must not exist, but a crate may replace an earlier
crate of the same run. After --to lammps, `lmp -in in.frame_CYCLE` in the written folder continues
the run from the checkpoint at CYCLE.
Examples:
  shearcell export 3f9a --to extxyz --cycles 0:60:10 --out run.xyz
  shearcell export 3f9a --to vtk --out frames
  shearcell export --experiment drag --variant fluid=cell --to extxyz --out packings
  shearcell export 3f9a --to ro-crate --out crate)");
}

}  // namespace shearcell::cli
