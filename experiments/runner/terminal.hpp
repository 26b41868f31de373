// SPDX-License-Identifier: GPL-3.0-or-later
// Output to terminals: width and capabilities, help pages, untrusted texts, progress.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "experiments/manifest/document.hpp"

namespace shearcell {

/// Width [columns] of the terminal to which the stream writes; empty for a file or a pipe.
std::optional<std::size_t> terminal_columns(std::FILE* stream);

/// Whether the stream is a terminal that obeys control sequences: TERM is set and is not "dumb".
bool moves_cursor(std::FILE* stream);

/// Whether colours may be written to the stream: moves_cursor() is true, and NO_COLOR
/// (https://no-color.org) is empty or not set.
bool shows_colours(std::FILE* stream);

/// Number of terminal columns that a UTF-8 text fills: two for most Chinese, Japanese and Korean
/// characters, zero for accents that combine with the previous character.
std::size_t columns_of(std::string_view text);

/// The longest beginning of a UTF-8 text that fits into `count` columns.
std::string_view first_columns(std::string_view text, std::size_t count);

/// Wraps a help page to `width` columns. The lines of a paragraph are joined and wrapped again.
/// An indented line is wrapped alone. If two or more blanks divide an indented line into two
/// columns, its continuation lines are indented to the beginning of the second column.
std::string filled(std::string_view help, std::size_t width);

/// fmt::print() for untrusted texts: control characters are escaped.
template <typename... Arguments>
void print_text(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  const std::string text = fmt::format(format, std::forward<Arguments>(arguments)...);
  fmt::print("{}", for_terminal(text));
}

/// Writes the text unchanged to standard error. Ignores failed writes, because a closed terminal or
/// a full disk must not end a campaign.
void write_stderr(std::string_view text) noexcept;

/// Like print_text(), but writes to standard error and ignores failed writes.
template <typename... Arguments>
void print_stderr(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  write_stderr(for_terminal(fmt::format(format, std::forward<Arguments>(arguments)...)));
}

/// Returns a function that shows "WHAT 3 of 10" for the arguments 3 and 10. The line is
/// overwritten if moves_cursor(stderr) is true. Otherwise, a line is added at most every ten
/// seconds. Not thread-safe.
std::function<void(std::size_t, std::size_t)> terminal_counter(std::string what);

}  // namespace shearcell
