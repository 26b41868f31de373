// SPDX-License-Identifier: GPL-3.0-or-later
// SIGINT and SIGTERM as a wish to stop: runs write a checkpoint and end; a second signal kills.
#pragma once

namespace shearcell {

/// Catches SIGINT and SIGTERM from now on.
void catch_stop_signals();

/// The same for a task of a batch system, which tells of an end to come by SIGTERM or SIGUSR1, may
/// do so several times, and kills by itself when its patience is over: only the first one counts.
void catch_batch_signals();

/// Whether one of them came.
bool stop_requested();

/// Asks to stop as a signal would; `false` takes the wish back.
void request_stop(bool stop);

}  // namespace shearcell
