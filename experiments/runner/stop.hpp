// SPDX-License-Identifier: GPL-3.0-or-later
// SIGINT, SIGTERM and SIGHUP are requests to stop: runs write a checkpoint and end. A second signal
// kills the program.
#pragma once

#include <stdexcept>

namespace shearcell {

/// Catches SIGINT and SIGTERM from now on, and SIGHUP unless it is ignored (nohup). Ignores
/// SIGPIPE, so that a campaign continues if the reader of its output ends.
void catch_stop_signals();

/// Replaces catch_stop_signals() in a task of a batch system. A batch system sends SIGTERM or
/// SIGUSR1, perhaps several times, and kills the task later. Only the first signal has an effect.
void catch_batch_signals();

bool stop_requested();

/// Thrown when a stop is requested before there is a state to record.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
};

/// Throws Interrupted if a stop is requested.
void give_up_if_requested();

/// Requests a stop as a signal does; with `false`, cancels the request.
void request_stop(bool stop);

}  // namespace shearcell
