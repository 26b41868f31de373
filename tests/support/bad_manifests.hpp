// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>

namespace shearcell::test {

struct BadManifest {
  std::string text;
  std::string message;  ///< expected when the file is named bad.yaml
};

/// The manifests of data/manifests/bad.txt, which explains its form, by name.
inline std::map<std::string, BadManifest> bad_manifests(const std::filesystem::path& data) {
  std::map<std::string, BadManifest> all;
  BadManifest* last = nullptr;
  std::ifstream file(data / "manifests" / "bad.txt");
  for (std::string line; std::getline(file, line);) {
    const std::size_t space = line.find(' ');
    if (last != nullptr && line.starts_with("@ ")) {
      last->message.append("\nbad.yaml:").append(line, 2);
    } else if (line.starts_with('@') || line.starts_with('+')) {
      const auto [place, is_new] = all.try_emplace(line.substr(1, space - 1));
      if (!is_new) throw std::runtime_error("bad.txt: two manifests are named " + place->first);
      last = &place->second;
      last->message.append("bad.yaml:").append(line, space + 1);
      if (line.front() == '+') last->text = "experiment: bad\nbase:\n  grains: 600\n";
    } else if (last != nullptr) {
      last->text += line + '\n';
    }
  }
  return all;
}

}  // namespace shearcell::test
