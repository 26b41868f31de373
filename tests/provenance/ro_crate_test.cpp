// SPDX-License-Identifier: GPL-3.0-or-later
// An exported crate meets RO-Crate 1.1 and Process Run Crate 0.5, and agrees with the log.
#include "provenance/ro_crate.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <set>

#include "tests/provenance/lineage_samples.hpp"

namespace shearcell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): the helpers of these tests

namespace fs = std::filesystem;
using nlohmann::json;

class Crate : public testing::Test {
 protected:
  void SetUp() override {
    files_ = write_ro_crate(store_, crate_facts(store_, history_.sheared), crate_);
    metadata_ = json::parse(read_bytes(crate_ / "ro-crate-metadata.json"));
    for (const json& entity : metadata_.at("@graph")) {
      EXPECT_TRUE(entities_.emplace(entity.at("@id"), entity).second) << entity.at("@id");
    }
  }
  std::vector<json> of_type(const std::string& type) const {
    std::vector<json> found;
    for (const auto& [id, entity] : entities_) {
      if (entity.at("@type") == type) found.push_back(entity);
    }
    return found;
  }
  const json& at(const json& reference) const { return entities_.at(reference.at("@id")); }

  TemporaryFolder folder_;
  Store store_{folder_.path() / "store", Access::create};
  SampleHistory history_{store_};
  fs::path crate_ = folder_.path() / "crate";
  std::vector<std::string> files_;
  json metadata_;
  std::map<std::string, json> entities_;
};

// Python is a second reader. Debian's modules belong to the Python in /usr/bin.
TEST_F(Crate, MeetsItsSpecificationsAndHoldsItsFiles) {
  const std::string command = std::string("PATH=/usr/bin:$PATH python3 ") + SHEARCELL_TEST_DATA +
                              "/../provenance/check_crate.py '" + crate_.string() + "'";
  EXPECT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(files_.size(), of_type("File").size() + 1);
  EXPECT_EQ(entities_.at("./").at("datePublished"), store_.stage(history_.sheared).updated_at);
  // One packing and three states; the rejected one is described but not copied.
  EXPECT_EQ(read_bytes(crate_ / "manifests" / (sha256_hex("manifest") + ".yaml")), "manifest");
  EXPECT_FALSE(entities_.contains("checkpoints/" + history_.rejected + ".h5"));
  EXPECT_EQ(entities_.at("#checkpoint-" + history_.rejected).at("sha256"), history_.rejected);
}

TEST_F(Crate, OneActionForEachAttempt) {
  const std::vector<json> actions = of_type("CreateAction");
  EXPECT_EQ(actions.size(), 5U);
  std::map<std::string, int> statuses;
  for (const json& action : actions) {
    const json& tool = at(action.at("instrument"));
    EXPECT_EQ(tool.at("@type"), "SoftwareApplication");
    EXPECT_EQ(tool.at("name"), "shearcell");
    EXPECT_TRUE(tool.at("softwareVersion").get<std::string>().starts_with("0.1.0 ("));
    ++statuses[action.at("actionStatus").at("@id")];
  }
  EXPECT_EQ(statuses["http://schema.org/CompletedActionStatus"], 2);
  EXPECT_EQ(statuses["http://schema.org/FailedActionStatus"], 3);
  EXPECT_EQ(of_type("SoftwareApplication").size(), 2U) << "two builds";
  EXPECT_EQ(of_type("Place").size(), 1U) << "one host";
}

TEST_F(Crate, AnActionHasManifestPackingSeedAndParameters) {
  const json& action = entities_.at("#attempt-" + history_.sheared + "-1");
  const std::string packing = run_lineage(store_, history_.sheared)[0].checkpoints[0].record.sha256;
  std::set<std::string> objects;
  std::map<std::string, json> values;
  for (const json& object : action.at("object")) {
    objects.insert(object.at("@id"));
    const json& entity = at(object);
    if (entity.at("@type") == "PropertyValue") values[entity.at("name")] = entity.at("value");
  }
  EXPECT_TRUE(objects.contains("checkpoints/" + packing + ".h5"));
  EXPECT_TRUE(objects.contains("manifests/" + sha256_hex("manifest") + ".yaml"));
  EXPECT_EQ(values, (std::map<std::string, json>{{"fluid", "cell"},
                                                 {"mass_kg", 2e-5},
                                                 {"seed", 7},
                                                 {"stage", "shear"},
                                                 {"target_cycles", 3}}));
}

TEST_F(Crate, AnActionHasNoLaterManifest) {
  std::this_thread::sleep_for(std::chrono::milliseconds(2));  // times are kept in milliseconds
  store_.register_manifest("later", "later.yaml", {{"experiment", "drag"}});
  const Stage run = store_.stage(history_.sheared);
  Stage again = sample_run(2, 3);
  again.parent = run.parent, again.resolved = run.resolved;
  again.memberships[0].place.manifest = sha256_hex("later");
  store_.declare_stage(again);
  const CrateFacts facts = crate_facts(store_, history_.sheared);
  EXPECT_EQ(facts.manifests.size(), 2U);
  const json metadata = ro_crate_metadata(facts);
  std::size_t objects = 0;
  for (const json& entity : metadata.at("@graph")) {
    for (const json& object : entity.value("object", json::array())) {
      ++objects;
      EXPECT_FALSE(has(object.at("@id").get<std::string>(), sha256_hex("later")));
    }
  }
  EXPECT_GT(objects, 0U);
}

TEST_F(Crate, EqualStoresGiveEqualBytes) {
  fs::copy(folder_.path() / "store", folder_.path() / "copy", fs::copy_options::recursive);
  const Store copy(folder_.path() / "copy", Access::read);
  for (const std::string& file :
       write_ro_crate(copy, crate_facts(copy, history_.sheared), folder_.path() / "other")) {
    EXPECT_EQ(read_bytes(crate_ / file), read_bytes(folder_.path() / "other" / file));
  }
}

TEST_F(Crate, UpdatesAnEarlierExportAndNothingElse) {
  const fs::path damaged = crate_ / files_.front();
  write_bytes(damaged, "spoilt");
  write_bytes(crate_ / "notes.txt", "mine");
  EXPECT_EQ(write_ro_crate(store_, crate_facts(store_, history_.sheared), crate_), files_);
  EXPECT_NE(read_bytes(damaged), "spoilt");
  EXPECT_EQ(read_bytes(crate_ / "notes.txt"), "mine");
  EXPECT_THROW(write_ro_crate(store_, crate_facts(store_, history_.packing), crate_), UsageError);

  const fs::path foreign = folder_.path() / "foreign";
  fs::create_directory(foreign);
  write_bytes(foreign / "ro-crate-metadata.json", "{\"@graph\":[{\"@id\":\"./\"}, 3]}");
  EXPECT_THROW(write_ro_crate(store_, crate_facts(store_, history_.sheared), foreign), UsageError);
  EXPECT_THROW(write_ro_crate(store_, crate_facts(store_, history_.sheared), crate_ / "notes.txt"),
               UsageError);
  EXPECT_THROW(write_ro_crate(store_, crate_facts(store_, history_.sheared), store_.folder()),
               UsageError);
}

TEST_F(Crate, FollowsNoLinkOutOfItsFolder) {
  const fs::path outside = folder_.path() / "outside";
  fs::create_directory(outside);
  fs::remove_all(crate_ / "checkpoints");
  fs::create_directory_symlink(outside, crate_ / "checkpoints");
  EXPECT_THROW(write_ro_crate(store_, crate_facts(store_, history_.sheared), crate_), UsageError);
  EXPECT_TRUE(fs::is_empty(outside));
  fs::remove(crate_ / "checkpoints");
  const fs::path manifest = crate_ / "manifests" / (sha256_hex("manifest") + ".yaml");
  fs::remove(manifest);
  write_bytes(outside / "precious", "precious");
  fs::create_symlink(outside / "precious", manifest);
  write_ro_crate(store_, crate_facts(store_, history_.sheared), crate_);
  EXPECT_EQ(read_bytes(outside / "precious"), "precious");
  EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(manifest)));
}

TEST_F(Crate, APrunedCheckpointIsListedAndNotCopied) {
  const CheckpointRecord record = store_.checkpoints(history_.sheared).at(1);
  fs::remove(store_.folder() / record.file);
  const fs::path pruned = folder_.path() / "pruned";
  EXPECT_THROW(write_ro_crate(store_, crate_facts(store_, history_.sheared), pruned), StoreDamaged);
  fs::remove_all(pruned);
  store_.prune({record});
  write_ro_crate(store_, crate_facts(store_, history_.sheared), pruned);
  EXPECT_FALSE(fs::exists(pruned / ("checkpoints/" + record.sha256 + ".h5")));
  const std::string metadata = read_bytes(pruned / "ro-crate-metadata.json");
  EXPECT_TRUE(has(metadata, "#checkpoint-" + record.sha256));
  write_bytes(crate_ / "checkpoints" / "notes", "of the user");
  EXPECT_TRUE(fs::exists(crate_ / ("checkpoints/" + record.sha256 + ".h5")));
  write_ro_crate(store_, crate_facts(store_, history_.sheared), crate_);
  EXPECT_FALSE(fs::exists(crate_ / ("checkpoints/" + record.sha256 + ".h5")))
      << "of an earlier one";
  EXPECT_TRUE(fs::exists(crate_ / "checkpoints" / "notes"));
  store_.restore_checkpoint(record, sample_checkpoint(history_.sheared, record.step));
  EXPECT_TRUE(run_lineage(store_, history_.sheared).back().find(record.sha256)->kept());
}

TEST_F(Crate, ADamagedCheckpointIsRefused) {
  const CheckpointRecord record = store_.checkpoints(history_.sheared).back();
  fs::resize_file(store_.folder() / record.file, 100);
  const fs::path fresh = folder_.path() / "fresh";
  expect_refused<StoreDamaged>(
      [&] { write_ro_crate(store_, crate_facts(store_, history_.sheared), fresh); }, {record.file});
  EXPECT_FALSE(fs::exists(fresh / "ro-crate-metadata.json"));
}

}  // namespace
}  // namespace shearcell
