// SPDX-License-Identifier: GPL-3.0-or-later
// `export`: one run in a form that other programs read.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <stdexcept>

#include "experiments/cli/command.hpp"
#include "provenance/ro_crate.hpp"

namespace shearcell::cli {
namespace {

struct ExportOptions {
  std::string run;
  std::string format;
  std::string out;
  std::string licence;
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

// A new format is one function and one line here.
constexpr std::array kFormats = {
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
    throw CLI::ValidationError("--out", problem.what());
  }
  if (context.json) {
    return print_json(
        {{"run", run.id}, {"format", options.format}, {"out", options.out}, {"files", files}});
  }
  fmt::print("run {:.12}: {} files in {}\n", run.id, files.size(), options.out);
}

}  // namespace

void add_export(CLI::App& app, Context& context) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* command = app.add_subcommand("export", "Write one run in a form that others read");
  command->add_option("run", options->run, "Run id, or a unique beginning of it")->required();
  command->add_option("--to", options->format, "Format")->required()->check(CLI::IsMember(names()));
  command->add_option("--out", options->out, "Folder to write to")->required()->type_name("PATH");
  command->add_option("--license", options->licence, "URI of the licence of the data")
      ->type_name("URI")
      ->check(check_uri);
  add_common_options(*command, context, true);
  std::string formats = "Formats:\n";
  for (const ExportFormat& format : kFormats) {
    formats += fmt::format("  {:<10} {}\n", format.name, format.title);
  }
  command->footer(formats +
                  "The folder must be new, empty, or an earlier export of the same run.\n"
                  "Examples:\n  shearcell export 3f9a --to ro-crate --out crate");
  command->callback([options, &context] { export_run(*options, context); });
}

}  // namespace shearcell::cli
