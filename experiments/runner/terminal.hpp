// SPDX-License-Identifier: GPL-3.0-or-later
// What the terminal behind a stream can show.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace shearcell {

/// Columns of the terminal behind the stream; none when it is a file or a pipe.
std::optional<std::size_t> terminal_columns(std::FILE* stream);

/// Whether colours may be written to the stream: a terminal, TERM is not "dumb", and NO_COLOR
/// (https://no-color.org) is not set to anything.
bool shows_colours(std::FILE* stream);

/// Without what a terminal takes for a command: control characters other than a line's end are
/// shown as \x1b.
std::string for_terminal(std::string_view text);

/// fmt::print, of texts that may be a stranger's.
template <typename... Arguments>
void tell(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  const std::string text = fmt::format(format, std::forward<Arguments>(arguments)...);
  fmt::print("{}", for_terminal(text));
}

}  // namespace shearcell
