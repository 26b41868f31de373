// SPDX-License-Identifier: GPL-3.0-or-later
// The report: everything that a store has to say to a person, in one HTML file that needs no
// network.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiments/report/packings.hpp"
#include "provenance/store.hpp"

namespace shearcell {

struct ReportOptions {
  std::optional<std::string> scale;  ///< of figures and packings; default: the one declared last
  /// Folder with the CSV files of `bench accuracy --out`; no such section without it.
  std::optional<std::filesystem::path> accuracy;
  PackingChoice packings;
  bool interactive = true;  ///< false: figures as drawings, as in a build without Node
  std::size_t workers = 1;
  std::function<void(std::size_t done, std::size_t total)> measured;  ///< may be empty
  std::function<void(std::size_t done, std::size_t total)> packed;    ///< may be empty
};

struct Report {
  std::string html;
  std::size_t experiments = 0;
  std::size_t figures = 0;
  std::size_t runs = 0;
  std::size_t packings = 0;  ///< runs of which checkpoints are shown
  std::size_t frames = 0;    ///< those checkpoints
  bool interactive = false;
  std::vector<std::string> damage;  ///< checkpoints that could not be read, one line each
  std::vector<std::string> notes;   ///< what else was left out, likewise
};

/// Whether this build holds the front end, which needs Node to be built.
bool has_front_end();

/// Reads the store and writes nothing but measures into its derived.sqlite. The same store and
/// options give the same bytes with the same program (drawings: with the same gnuplot). Throws
/// NotFound when the store has no experiment or a run of `packings.runs` is unknown, and UsageError
/// when the folder of `accuracy` holds no CSV file that this program can read.
Report make_report(const Store& store, const ReportOptions& options);

}  // namespace shearcell
