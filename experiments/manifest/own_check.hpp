// SPDX-License-Identifier: GPL-3.0-or-later
// Can the plots and claims of a manifest be made from the runs of one scale?
#pragma once

#include <string>
#include <vector>

#include "experiments/manifest/manifest.hpp"

namespace shearcell {

/// A warning for each plot or claim that `shearcell figures` would refuse or leave without data: a
/// side of `between` that is not one variant, a plot that would average over a swept key that it
/// does not name, cycles beyond the end of the runs, `at_cycle` where every cycle is drawn. `scale`
/// states everything (whole_scale()).
std::vector<std::string> own_warnings(const Manifest& manifest, const Scale& scale);

}  // namespace shearcell
