// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the parts of manifests: values, counts, lists, sweeps. Problems go to a ProblemList, and
// reading continues.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "experiments/manifest/document.hpp"
#include "experiments/manifest/manifest.hpp"
#include "experiments/manifest/problems.hpp"
#include "experiments/manifest/schema.hpp"

namespace shearcell {

/// The value of a parameter, of its type and in its range.
std::optional<nlohmann::json> read_parameter(const Field& field, const Node& node,
                                             const std::string& key, ProblemList& problems);

/// Whether the node is the word `auto` where the parameter takes it.
bool is_auto(const Field& field, const Node& node);

/// A whole number from 1 to `largest`.
std::optional<std::uint64_t> read_count(const Node& node, const std::string& key,
                                        std::uint64_t largest, ProblemList& problems);

/// The items of a list that is neither empty nor over-long; none when it is.
std::span<const Node> read_list(const Node& node, const std::string& key, std::string_view example,
                                ProblemList& problems);

Sweep read_sweep(const Node& node, const std::string& path, ProblemList& problems);

Checkpoints read_checkpoints(const Node& node, const std::string& path, ProblemList& problems);

StatedUntil read_until(const Node& node, const std::string& key, ProblemList& problems);

std::vector<VariantLabel> read_labels(const Node& node, ProblemList& problems);

/// Add to the manifest's plots or claims, whose names are all different.
void read_plots(const Node& node, Manifest& manifest, ProblemList& problems);
void read_claims(const Node& node, Manifest& manifest, ProblemList& problems);

Seeds read_seeds(const Node& node, const std::string& key, ProblemList& problems);

}  // namespace shearcell
