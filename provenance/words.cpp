// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/words.hpp"

#include <fmt/format.h>

#include <cmath>

namespace shearcell {

std::string counted(std::size_t number, std::string_view one) {
  return fmt::format("{} {}{}", number, one, number == 1 ? "" : "s");
}

void add_note(std::string& note, std::string_view part, std::string_view separator) {
  if (!note.empty() && !part.empty()) note += separator;
  note += part;
}

std::string format_duration(double seconds) {
  constexpr double year = 365.25 * 86400;
  if (!std::isfinite(seconds)) return "?";
  if (seconds > 10 * year) return fmt::format("{:.3g} years", seconds / year);
  const auto total = static_cast<long long>(std::llround(seconds));
  if (total < 60) return fmt::format("{} s", total);
  if (total < 3600) return fmt::format("{} min {:02} s", total / 60, total % 60);
  const auto minutes = std::llround(seconds / 60);
  if (minutes < 48 * 60) return fmt::format("{} h {:02} min", minutes / 60, minutes % 60);
  return fmt::format("{} d {:02} h", minutes / 1440, minutes / 60 % 24);
}

}  // namespace shearcell
