// SPDX-License-Identifier: GPL-3.0-or-later
// What a benchmark found, as a row of a table, CSV or JSON.
#pragma once

#include <string>
#include <vector>

#include "analysis/chart.hpp"

namespace shearcell::bench {

/// A value of a result, for JSON and CSV. With a heading it is also in the printed table: as `text`
/// if given, else the value itself.
struct Fact {
  std::string key;
  TableValue value;
  std::string heading = {}, text = {};
};
using Facts = std::vector<Fact>;

}  // namespace shearcell::bench
