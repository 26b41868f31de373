// SPDX-License-Identifier: GPL-3.0-or-later
// What the terminal of a stream can display.
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

/// Columns of the terminal behind the stream; none when it is a file or a pipe.
std::optional<std::size_t> terminal_columns(std::FILE* stream);

/// Whether the stream is a terminal that obeys control sequences: TERM is set, and not "dumb".
bool moves_cursor(std::FILE* stream);

/// Whether colours may be written to the stream: such a terminal, and NO_COLOR
/// (https://no-color.org) is not set to anything.
bool shows_colours(std::FILE* stream);

/// Columns of a terminal that a UTF-8 text takes: two for most Chinese, Japanese and Korean
/// characters, none for accents that join the character before them.
std::size_t columns_of(std::string_view text);

/// The beginning of a UTF-8 text that takes at most `count` columns.
std::string_view first_columns(std::string_view text, std::size_t count);

/// Fits a help page into `width` columns. Lines of a paragraph are joined and broken again.
/// Indented lines are not joined; where they are broken, the rest is indented as far as their last
/// column.
std::string filled(std::string_view help, std::size_t width);

/// fmt::print of untrusted texts.
template <typename... Arguments>
void print_text(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  const std::string text = fmt::format(format, std::forward<Arguments>(arguments)...);
  fmt::print("{}", for_terminal(text));
}

/// Writes to standard error as it is. A message that cannot be written is lost: a closed terminal
/// or a full disk must not end a campaign.
void write_stderr(std::string_view text) noexcept;

/// `print_text` on standard error, by write_stderr.
template <typename... Arguments>
void print_stderr(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  write_stderr(for_terminal(fmt::format(format, std::forward<Arguments>(arguments)...)));
}

/// A function that shows "WHAT done of total" on standard error: on one line of a terminal; else as
/// a new line, at most every ten seconds. Not thread-safe.
std::function<void(std::size_t, std::size_t)> terminal_counter(std::string what);

}  // namespace shearcell
