// SPDX-License-Identifier: GPL-3.0-or-later
// Formats counts and durations for messages, and joins notes.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace shearcell {

/// "1 run", "2 runs".
std::string counted(std::size_t number, std::string_view one);

/// "7 s", "4 min 05 s", "1 h 02 min", "3 d 07 h" or "12 years".
std::string format_duration(double seconds);

/// Adds a part to a note or a caption. Captions consist of sentences, so their separator is ". ".
void add_note(std::string& note, std::string_view part, std::string_view separator = "; ");

}  // namespace shearcell
