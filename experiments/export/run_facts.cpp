// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>

#include "experiments/export/formats.hpp"
#include "provenance/io/plain_file.hpp"

namespace shearcell {

FrameWriter facts_writer(const std::filesystem::path& folder) {
  using Json = nlohmann::ordered_json;
  return [folder, frames = std::make_shared<Json>(Json::array())](const Frame& f) {
    Json all = {{"units", "SI: m, kg, s; others are in the names"}};
    constexpr std::size_t kIdentity = 5;  // the run, and how its experiment names it
    for (std::size_t i = 0; i < f.facts.size(); ++i) {
      const auto& [key, value] = f.facts[i];
      (i < kIdentity ? all[key] : all["parameters"][key]) = value;
    }
    Json frame = {{"cycle", f.cycle}, {"time_s", f.time_s}, {"checkpoint", f.checkpoint}};
    for (const auto& [name, value] : f.scalars) frame[name] = value;  // NaN as null
    frames->push_back(std::move(frame));
    all["frames"] = *frames;
    write_output(folder / "run.json",
                 all.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
  };
}

}  // namespace shearcell
