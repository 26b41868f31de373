// SPDX-License-Identifier: GPL-3.0-or-later
// The folder of a crate.
#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <stdexcept>

#include "provenance/io/file.hpp"
#include "provenance/json_text.hpp"
#include "provenance/limits.hpp"
#include "provenance/ro_crate.hpp"

namespace shearcell {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

bool is_crate_of(const fs::path& folder, const std::string& run) {
  const auto text = read_plain(folder / kCrateMetadata, StoreLimits::value_bytes);
  const json graph = member_of(parse_json(text.value_or("")), "@graph");
  return graph.is_array() && std::any_of(graph.begin(), graph.end(), [&](const json& entity) {
           return member_of(entity, "@id") == "./" &&
                  member_of(entity, "identifier") == crate_identifier(run);
         });
}

/// Creates a folder in the crate; a link is refused.
void make_subfolder(const fs::path& crate, const char* name) {
  const fs::path path = crate / name;
  const fs::file_status status = fs::symlink_status(path);
  if (fs::exists(status) && !fs::is_directory(status)) {
    throw std::invalid_argument(path.string() +
                                ": this must be a folder, but it is a file or a link; remove it");
  }
  fs::create_directory(path);
}

std::vector<std::string> fill(const Store& store, const CrateFacts& facts, const fs::path& folder) {
  const ObjectStore objects(store.folder());
  std::vector<std::string> written;
  for (const char* subfolder : {"checkpoints", "manifests"}) make_subfolder(folder, subfolder);
  std::set<std::string> done;
  for (const RunLineage& stage : facts.stages) {
    for (const CheckpointHistory& c : stage.checkpoints) {
      if (!c.kept() || !done.insert(c.record.sha256).second) continue;
      const std::vector<std::byte> bytes = objects.get(c.record.sha256, c.record.size);
      const std::string path = crate_path_of_checkpoint(c.record.sha256);
      write_output(folder / path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
      written.push_back(path);
    }
  }
  // An earlier export wrote what was pruned or rejected since.
  for (const RunLineage& stage : facts.stages) {
    for (const CheckpointHistory& c : stage.checkpoints) {
      if (!done.contains(c.sha256())) fs::remove(folder / crate_path_of_checkpoint(c.sha256()));
    }
  }
  for (const ManifestText& manifest : facts.manifests) {
    written.push_back(crate_path_of_manifest(manifest.sha256));
    write_output(folder / written.back(), manifest.text);
  }
  // Last, because it describes the other files. Bytes that are not UTF-8 are replaced.
  write_output(folder / kCrateMetadata,
               ro_crate_metadata(facts).dump(1, ' ', false, json::error_handler_t::replace) + '\n');
  written.emplace_back(kCrateMetadata);
  return written;
}

}  // namespace

std::vector<std::string> write_ro_crate(const Store& store, const std::string& run,
                                        const fs::path& where, const std::string& licence,
                                        const std::vector<std::string>& left_out) {
  const CrateFacts facts = crate_facts(store, run, licence, left_out);
  // "crate/" has no file name; "crate" is the same folder.
  const fs::path given = fs::absolute(where);
  const fs::path folder = given.has_filename() ? given : given.parent_path();
  const fs::file_status status = fs::symlink_status(folder);
  if (fs::exists(status) && !fs::is_directory(status)) {
    throw std::invalid_argument(folder.string() +
                                ": this is a file or a link; name another folder");
  }
  if (fs::exists(status) && !fs::is_empty(folder)) {
    if (!is_crate_of(folder, run)) {
      throw std::invalid_argument(folder.string() +
                                  ": the folder is not an export of this run; name another one");
    }
    return fill(store, facts, folder);
  }
  // On the same file system as the folder, to be renamed to it.
  fs::create_directories(folder.parent_path());
  const TemporaryFolder beside(folder.parent_path() /
                               fmt::format(".{}.tmp-", folder.filename().string()));
  const fs::path staged = beside.path() / "crate";
  fs::create_directory(staged);
  std::vector<std::string> written = fill(store, facts, staged);
  fs::rename(staged, folder);
  return written;
}

}  // namespace shearcell
