// SPDX-License-Identifier: GPL-3.0-or-later
// What the supplement claims of a figure, as a test with a number.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace shearcell {

enum class Ruling { pass, fail, too_few_runs };

/// "pass", "fail", "too few runs to tell".
const char* name_of(Ruling ruling);

struct Verdict {
  std::string claim;            ///< in the supplement's sense, with its section
  std::string quantity;         ///< what `value` is, with its unit
  std::optional<double> value;  ///< none when nothing could be measured
  std::optional<double> limit;  ///< what `value` is compared with
  Ruling ruling = Ruling::too_few_runs;
  std::string note;  ///< how many runs, what is missing; may be empty
};

/// Passes when value < limit. Nothing can be told without a value.
Verdict below(std::string claim, std::string quantity, std::optional<double> value, double limit,
              std::string note = "");

/// The same, but nothing can be told unless `enough`.
Verdict below_if(bool enough, std::string claim, std::string quantity, std::optional<double> value,
                 double limit, std::string note = "");

/// fail when any claim fails; else too few runs when any could not be told, or when there is none.
Ruling overall(std::span<const Verdict> verdicts);

/// {"verdict", "claims": [{"claim", "quantity", "value", "limit", "verdict", "note"}]}; numbers to
/// six significant digits, null where there is none. The same verdicts give the same bytes.
nlohmann::json to_json(std::span<const Verdict> verdicts);

}  // namespace shearcell
