// SPDX-License-Identifier: GPL-3.0-or-later
// SIGINT, SIGTERM and SIGHUP as a request to stop: runs write a checkpoint and end; a second
// signal kills.
#pragma once

#include <stdexcept>

namespace shearcell {

/// Catches SIGINT and SIGTERM from now on, and SIGHUP unless it is ignored (nohup). Ignores
/// SIGPIPE: nobody needs to read the progress of a campaign.
void catch_stop_signals();

/// catch_stop_signals() for a task of a batch system, which announces the end by SIGTERM or
/// SIGUSR1, perhaps several times, and kills the task later. Only the first signal counts.
void catch_batch_signals();

/// Whether a signal arrived that asks to stop.
bool stop_requested();

/// Thrown when a stop is requested before there is a state to record.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
};

/// Throws Interrupted if a stop is requested.
void give_up_if_requested();

/// Requests a stop as a signal would; `false` withdraws it.
void request_stop(bool stop);

}  // namespace shearcell
