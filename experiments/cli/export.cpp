// SPDX-License-Identifier: GPL-3.0-or-later
// `export`: one run in a form that other programs read.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <type_traits>

#include "experiments/cli/command.hpp"
#include "experiments/export/formats.hpp"
#include "experiments/runner/terminal.hpp"
#include "provenance/ro_crate.hpp"

namespace shearcell::cli {
namespace {

namespace fs = std::filesystem;

struct ExportOptions {
  std::string run;
  std::string format;
  std::string out;
  std::string licence;
  std::string cycles;  ///< "A:B" or "A:B:STEP", each may be empty; "" for all
};

struct ExportFormat {
  const char* name;
  const char* title;
  /// Writes to options.out and returns the files, relative to it. Throws std::invalid_argument when
  /// something that is not its own stands there.
  std::vector<std::string> (*write)(const Store&, const RunRecord&, const ExportOptions&);
};

std::vector<std::string> ro_crate(const Store& store, const RunRecord& run,
                                  const ExportOptions& options) {
  return write_ro_crate(store, run.id, options.out, options.licence);
}

struct CycleRange {
  double first = 0;
  double last = std::numeric_limits<double>::infinity();
  double every = 0;  ///< 0 takes all

  bool holds(double cycle) const {
    return cycle >= first && cycle <= last && (every == 0 || std::fmod(cycle - first, every) == 0);
  }
};

/// Throws std::invalid_argument.
CycleRange parse_cycles(const std::string& text) {
  CycleRange range;
  std::istringstream parts(text);
  double* const values[] = {&range.first, &range.last, &range.every};
  std::size_t k = 0;
  for (std::string part; std::getline(parts, part, ':'); ++k) {
    std::size_t used = 0;
    if (part.empty() && k < 3) continue;
    const double value = k < 3 && std::isdigit(part.front()) ? std::stod(part, &used) : 0;
    if (used == 0 || used != part.size()) {
      throw std::invalid_argument("--cycles takes A:B or A:B:STEP, such as 0:60 or ::10 (got " +
                                  text + ")");
    }
    *values[k] = value;
  }
  if (k == 1 && text.find(':') == std::string::npos) range.last = range.first;
  return range;
}

std::vector<CheckpointRecord> chosen(const Store& store, const RunRecord& run,
                                     const std::string& cycles) {
  const CycleRange range = parse_cycles(cycles);
  std::vector<CheckpointRecord> records;
  for (CheckpointRecord& record : store.checkpoints(run.id)) {
    if (range.holds(record.cycle)) records.push_back(std::move(record));
  }
  if (records.empty()) {
    throw std::invalid_argument(fmt::format(
        "run {:.8} has no stored checkpoint in cycles {} (pruned ones: `shearcell regenerate`)",
        run.id, cycles.empty() ? "of any number" : cycles));
  }
  return records;
}

void require_new(const fs::path& out) {
  if (fs::exists(fs::symlink_status(out)) && !(fs::is_directory(out) && fs::is_empty(out))) {
    throw std::invalid_argument(out.string() + " exists already. Name a new one.");
  }
}

void write_frames(const Store& store, const std::vector<CheckpointRecord>& records,
                  const FrameWriter& write) {
  for (const CheckpointRecord& record : records) write(frame_of(store.load_checkpoint(record)));
}

/// Names of the files below `folder`, or its own when it is one.
std::vector<std::string> files_of(const fs::path& out) {
  std::vector<std::string> files;
  if (!fs::is_directory(out)) return {out.filename().string()};
  for (const auto& entry : fs::directory_iterator(out)) {
    files.push_back(entry.path().filename().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

enum class Output { file, folder };

template <auto Writer, Output Kind>
std::vector<std::string> frames(const Store& store, const RunRecord& run,
                                const ExportOptions& options) {
  const std::vector<CheckpointRecord> records = chosen(store, run, options.cycles);
  require_new(options.out);
  if constexpr (Kind == Output::folder) fs::create_directories(options.out);
  if constexpr (std::is_invocable_v<decltype(Writer), fs::path, std::size_t>) {
    write_frames(store, records, Writer(options.out, records.size()));
  } else {
    write_frames(store, records, Writer(options.out));
  }
  return files_of(options.out);
}

// A new format is one function and one line here.
constexpr std::array kFormats = {
    ExportFormat{"h5md", "H5MD 1.1, one file: MDAnalysis, h5py, VMD",
                 frames<h5md_writer, Output::file>},
    ExportFormat{"extxyz", "extended XYZ, one file: OVITO, ASE",
                 frames<extxyz_writer, Output::file>},
    ExportFormat{"vtk", "VTK PolyData, a folder: ParaView", frames<vtk_writer, Output::folder>},
    ExportFormat{"lammps", "LAMMPS data, a folder: LAMMPS, OVITO",
                 frames<lammps_writer, Output::folder>},
    ExportFormat{"ro-crate", "RO-Crate 1.1 with Process Run Crate 0.5, and PROV-JSON", ro_crate},
};

// Anything else would be read as a file of the crate.
std::string check_uri(const std::string& text) {
  const bool web = text.starts_with("https://") || text.starts_with("http://");
  return web && text.find_first_of(" \"<>\\") == std::string::npos
             ? ""
             : text + " is no URI that begins with https://, as that of a licence does";
}

std::vector<std::string> names() {
  std::vector<std::string> list;
  for (const ExportFormat& format : kFormats) list.emplace_back(format.name);
  return list;
}

void export_run(const ExportOptions& options, Context& context) {
  const Store store(context.store, Access::read);
  const RunRecord run = store.find_run(options.run);
  const auto* format =
      std::find_if(kFormats.begin(), kFormats.end(),
                   [&](const ExportFormat& known) { return known.name == options.format; });
  std::vector<std::string> files;
  try {
    files = format->write(store, run, options);
  } catch (const std::invalid_argument& problem) {
    throw CLI::ValidationError("export", problem.what());
  }
  if (context.json) {
    return print_json(
        {{"run", run.id}, {"format", options.format}, {"out", options.out}, {"files", files}});
  }
  tell("run {:.12}: {} files in {}\n", run.id, files.size(), options.out);
}

}  // namespace

void add_export(CLI::App& app, Context& context) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* command = app.add_subcommand("export", "Write one run in a form that others read");
  command->add_option("run", options->run, "Run id, or a unique beginning of it")->required();
  command->add_option("--to", options->format, "Format")->required()->check(CLI::IsMember(names()));
  command->add_option("--out", options->out, "File or folder to write")
      ->required()
      ->type_name("PATH");
  command->add_option("--cycles", options->cycles, "Checkpoints of these cycles (default: all)")
      ->type_name("A:B[:STEP]");
  command->add_option("--license", options->licence, "URI of the licence of the data")
      ->type_name("URI")
      ->check(check_uri);
  add_common_options(*command, context, true);
  std::string formats = "Formats:\n";
  for (const ExportFormat& format : kFormats) {
    formats += fmt::format("  {:<10} {}\n", format.name, format.title);
  }
  command->footer(
      formats +
      "Frames have SI units, and for each grain id, radius, velocity, phi_local, q6, structure,\n"
      "crystallite and largest overlap; wall grains and the tilted cell are in them. The file or\n"
      "folder must be new; that of a crate may be an earlier export of the same run.\n"
      "Examples:\n"
      "  shearcell export 3f9a --to extxyz --cycles 0:60:10 --out run.xyz\n"
      "  shearcell export 3f9a --to vtk --out frames\n"
      "  shearcell export 3f9a --to ro-crate --out crate");
  command->callback([options, &context] { export_run(*options, context); });
}

}  // namespace shearcell::cli
