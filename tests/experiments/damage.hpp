// SPDX-License-Identifier: GPL-3.0-or-later
// Ways to damage or forge a store that bypass the program's own checks.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "provenance/checkpoint.hpp"
#include "provenance/event_log.hpp"

namespace shearcell::test {

using Damage = std::function<void(const std::filesystem::path& store)>;

/// SQL statements on the log, without the program's limits and triggers.
Damage sql(const std::string& statements);

/// Changes events and recomputes the chain, as a forger who knows the format would.
Damage forged(const std::function<void(Event&)>& change);

/// The same for the payload of every event of a type.
Damage payload(const std::string& type, const std::function<void(nlohmann::json&)>& change);

/// The damage, then `rebuild`, so that the tables agree with the events.
Damage rebuilt(const Damage& damage);

/// Changes every checkpoint with its file, its hashes and all events that name it, so that the
/// store is consistent.
Damage states(const std::function<void(Checkpoint&)>& change);

/// Changes every kept measure of this name and updates its digest.
Damage measures(const std::string& name, const std::function<void(nlohmann::json&)>& change);

/// The damage, and no kept measures, so that figures read the files.
Damage unmeasured(const Damage& damage);

/// Changes a file or folder of the store.
Damage at(const std::string& name, const std::function<void(const std::filesystem::path&)>& change);

/// Changes one checkpoint file.
Damage object(const std::function<void(const std::filesystem::path& file)>& change);

std::filesystem::path an_object(const std::filesystem::path& store);

// Changes of a file. The link points to the original, which is moved.
std::function<void(const std::filesystem::path&)> written(const std::string& bytes);
void removed(const std::filesystem::path& path);
void link_instead(const std::filesystem::path& path);
void pipe_instead(const std::filesystem::path& path);
void folder_instead(const std::filesystem::path& path);

/// Replaces every checkpoint by these bytes, with a right digest in the file and in the log.
void forge_checkpoints(const std::filesystem::path& store, const std::string& hdf5);

}  // namespace shearcell::test
