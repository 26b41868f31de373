// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of the notes of verdicts.
#pragma once

#include <string>

namespace shearcell {

inline constexpr const char* no_group =
    "the claim selects no runs, or its runs differ in a swept parameter that is not in the claim";

inline void add_note(std::string& note, const std::string& text) {
  note += (note.empty() ? "" : "; ") + text;
}

}  // namespace shearcell
