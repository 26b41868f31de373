// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "provenance/io/child_process.hpp"

namespace shearcell {

/// Another program that a computation needs is missing or went wrong; what() says what to do.
using EngineError = ProgramError;

}  // namespace shearcell
