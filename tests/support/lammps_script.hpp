// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the script that an export writes for LAMMPS's users, and reads the dumps of LAMMPS.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "experiments/runner/lammps/lammps_run.hpp"

namespace shearcell::test {

/// The last frame of a dump: the values of each column, sorted by the column id.
using DumpFrame = std::map<std::string, Eigen::VectorXd>;

inline DumpFrame last_frame(const std::filesystem::path& file) {
  const std::string text = read_plain(file, kLargestFile).value_or("");
  const auto at = text.rfind("ITEM: ATOMS ");
  if (at == text.npos) throw ProgramError(file.string() + " is no dump");
  std::istringstream lines(text.substr(at + 12));
  std::string line;
  std::getline(lines, line);
  std::istringstream header(line);
  std::vector<std::string> names;
  for (std::string name; header >> name;) names.push_back(name);
  std::map<double, std::map<std::string, double>> rows;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::map<std::string, double> row;
    for (const std::string& name : names) words >> row[name];
    rows[row.at("id")] = row;
  }
  DumpFrame frame;
  for (const std::string& name : names) {
    Eigen::VectorXd& column = frame[name];
    column.resize(static_cast<Eigen::Index>(rows.size()));
    Eigen::Index k = 0;
    for (const auto& [id, row] : rows) column[k++] = row.at(name);
  }
  return frame;
}

/// 3 x N, of the columns a, b and c.
inline Eigen::Matrix3Xd three(const DumpFrame& frame, const char* a, const char* b, const char* c) {
  Eigen::Matrix3Xd all(3, frame.at(a).size());
  all << frame.at(a).transpose(), frame.at(b).transpose(), frame.at(c).transpose();
  return all;
}

/// Runs LAMMPS on a script in that folder.
inline void run_script(const std::filesystem::path& folder, const std::string& script,
                       const std::vector<std::string>& options) {
  std::vector<std::string> words = {lammps_name(), "-in", script, "-screen", "none"};
  words.insert(words.end(), options.begin(), options.end());
  const auto ran = run_program(words, folder);
  ASSERT_TRUE(ran && ran->code == 0)
      << read_plain(folder / "log.lammps", kLargestFile).value_or("");
}

}  // namespace shearcell::test
