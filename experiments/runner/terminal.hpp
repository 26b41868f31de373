// SPDX-License-Identifier: GPL-3.0-or-later
// What the terminal behind a stream can show.
#pragma once

#include <cstddef>
#include <cstdio>
#include <optional>

namespace shearcell {

/// Columns of the terminal behind the stream; none when it is a file or a pipe.
std::optional<std::size_t> terminal_columns(std::FILE* stream);

/// Whether colours may be written to the stream: a terminal, TERM is not "dumb", and NO_COLOR
/// (https://no-color.org) is not set to anything.
bool shows_colours(std::FILE* stream);

}  // namespace shearcell
