// SPDX-License-Identifier: GPL-3.0-or-later
// Payloads of older layouts, read as the newest one. What was written is never rewritten.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string_view>

namespace shearcell {

/// The layout in which this program writes payloads of a type; 1 for types that never changed.
std::uint64_t newest_schema(std::string_view type);

/// A payload of layout `schema` in the newest layout of its type. Throws StoreDamaged when the
/// layout is newer than this program knows.
nlohmann::json upcast(std::string_view type, std::uint64_t schema, nlohmann::json payload);

}  // namespace shearcell
