// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>

#include "experiments/figures/lineage.hpp"
#include "experiments/report/report_data.hpp"
#include "provenance/errors.hpp"
#include "tests/fuzz/seeds.hpp"
#include "tests/fuzz/targets.hpp"
#include "tests/provenance/samples.hpp"

namespace shearcell::fuzz {
namespace {

/// A store that knows a figure, and a folder to put files into.
struct Place {
  TemporaryFolder folder;
  std::filesystem::path published = folder.path() / "published";
  Store store;
  Place() : store(make_store(folder.path() / "store"), Access::read) {
    std::filesystem::create_directory(published);
  }
};

/// The CSV, and after a NUL the lineage file and the chart beside it.
void run(Input input) {
  static const Place place;
  const std::string_view text = text_of(input);
  const std::size_t end = std::min(text.find('\0'), text.size());
  test::write_bytes(place.published / "S2a.csv", std::string(text.substr(0, end)));
  const std::string second(text.substr(std::min(end + 1, text.size())));
  test::write_bytes(place.published / "S2.lineage.json", second);
  test::write_bytes(place.published / "S2a.chart.json", second);
  for (const char* name : {"S2a.csv", "S2.lineage.json"}) {
    const auto found = find_published(place.store, place.published / name);
    require(found.has_value(), "the figure that the file is named after is found");
  }
  try {
    read_accuracy_charts(place.published);
  } catch (const UsageError&) {
  }
}

}  // namespace

const Target published_target{"published", run, published_seeds};

}  // namespace shearcell::fuzz
