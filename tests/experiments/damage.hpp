// SPDX-License-Identifier: GPL-3.0-or-later
// Ways to damage or forge a store, behind the back of the program's own checks.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "provenance/checkpoint.hpp"
#include "provenance/event_log.hpp"

namespace shearcell::test {

using Damage = std::function<void(const std::filesystem::path& store)>;

/// Statements on the log, without this program's limits and triggers.
Damage sql(const std::string& statements);

/// Changes events and recomputes the chain, as a forger who knows the format would.
Damage forged(const std::function<void(Event&)>& change);

/// The same of the payload of every event of a type.
Damage payload(const std::string& type, const std::function<void(nlohmann::json&)>& change);

/// Followed by `rebuild`, so that the tables say what the events say.
Damage rebuilt(const Damage& damage);

/// Changes every checkpoint together with its file, its hashes and all events that name it: a
/// store that is consistent in itself.
Damage states(const std::function<void(Checkpoint&)>& change);

/// Changes every kept measure of this name and gives it the digest that belongs to it.
Damage measures(const std::string& name, const std::function<void(nlohmann::json&)>& change);

/// To a file or folder of the store.
Damage at(const std::string& name, const std::function<void(const std::filesystem::path&)>& change);

/// To one checkpoint file.
Damage object(const std::function<void(const std::filesystem::path& file)>& change);

std::filesystem::path an_object(const std::filesystem::path& store);

// What may be done to a file. Links point to what stood there.
std::function<void(const std::filesystem::path&)> written(const std::string& bytes);
void removed(const std::filesystem::path& path);
void link_instead(const std::filesystem::path& path);
void pipe_instead(const std::filesystem::path& path);
void folder_instead(const std::filesystem::path& path);

/// Bytes of one's own under a right digest in the place of every checkpoint, and a log that vouches
/// for them.
void forge_checkpoints(const std::filesystem::path& store, const std::string& hdf5);

}  // namespace shearcell::test
