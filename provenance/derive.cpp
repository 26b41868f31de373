// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/derive.hpp"

#include <variant>

#include "provenance/errors.hpp"
#include "provenance/events.hpp"
#include "provenance/projections.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {

sqlite::Database empty_projections(const std::string& name) {
  sqlite::Database tables = sqlite::Database::in_memory(name);
  tables.execute("PRAGMA foreign_keys=ON");
  create_projections(tables);
  return tables;
}

std::string try_apply(sqlite::Database& tables, const Event& event) {
  try {
    apply(tables, event);
    const events::Any decoded = events::decode(event);
    const auto* manifest = std::get_if<events::ManifestRegistered>(&decoded);
    if (manifest == nullptr || event.stream == "manifest/" + sha256_hex(manifest->text)) return "";
    return "the manifest's text has another SHA-256";
  } catch (const StoreDamaged& damage) {
    return damage.what();
  } catch (const nlohmann::json::exception& problem) {
    return problem.what();
  }
}

}  // namespace shearcell
