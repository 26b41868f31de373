// SPDX-License-Identifier: GPL-3.0-or-later
// What the sections on whole packings share.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "analysis/statistics.hpp"
#include "experiments/bench/accuracy/accuracy.hpp"
#include "experiments/bench/accuracy/sheared.hpp"

namespace shearcell::accuracy {

/// Table I in a cell of 600 grains; of 300 where it has to be quick.
Parameters small_cell(bool quick);

/// Settled packings of seeds 1 to `seeds`.
std::vector<Packing> packings(const Options& options, std::size_t seeds);

/// work(n) for n < count, `jobs` at once. The first exception is thrown on.
void in_parallel(std::size_t count, std::size_t jobs, const std::function<void(std::size_t)>& work);

/// Seconds of one core per cycle at the engine's rate [million particle-steps/s].
double seconds_per_cycle(const Parameters& parameters, double time_step, double engine_rate);

/// Three significant digits; empty for what is not finite.
std::string short_number(double value);
/// "mean +- standard error".
std::string with_error(const RunStatistics& of, int digits);

}  // namespace shearcell::accuracy
