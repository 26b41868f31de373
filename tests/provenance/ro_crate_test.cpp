// SPDX-License-Identifier: GPL-3.0-or-later
// An exported crate meets RO-Crate 1.1, Process Run Crate 0.5 and PROV-JSON, and agrees with the
// log.
#include "provenance/ro_crate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <sstream>

#include "tests/provenance/lineage_samples.hpp"

namespace shearcell {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class Crate : public testing::Test {
 protected:
  void SetUp() override {
    files_ = write_ro_crate(store_, history_.sheared, crate_);
    metadata_ = json::parse(test::read_bytes(crate_ / "ro-crate-metadata.json"));
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
  test::SampleHistory history_{store_};
  fs::path crate_ = folder_.path() / "crate";
  std::vector<std::string> files_;
  json metadata_;
  std::map<std::string, json> entities_;
};

/// ISO 8601 in UTC with milliseconds.
bool is_moment(const json& value) {
  const std::string text = value.get<std::string>(), pattern = "0000-00-00T00:00:00.000Z";
  return std::equal(text.begin(), text.end(), pattern.begin(), pattern.end(),
                    [](char c, char p) { return p == '0' ? c >= '0' && c <= '9' : c == p; });
}

void for_each_reference(const json& value, const std::function<void(const std::string&)>& visit) {
  if (value.is_object() && value.size() == 1 && value.contains("@id")) visit(value.at("@id"));
  if (!value.is_structured()) return;
  for (const json& inner : value) for_each_reference(inner, visit);
}

TEST_F(Crate, TheDescriptorLeadsToTheRoot) {
  EXPECT_EQ(metadata_.at("@context"),
            json::array({"https://w3id.org/ro/crate/1.1/context",
                         "https://w3id.org/ro/terms/workflow-run/context"}));
  const json& descriptor = entities_.at("ro-crate-metadata.json");
  EXPECT_EQ(descriptor.at("@type"), "CreativeWork");
  EXPECT_EQ(descriptor.at("conformsTo").at("@id"), "https://w3id.org/ro/crate/1.1");
  const json& root = at(descriptor.at("about"));
  EXPECT_EQ(root.at("@id"), "./");
  EXPECT_EQ(root.at("@type"), "Dataset");
  EXPECT_FALSE(root.at("name").get<std::string>().empty());
  EXPECT_FALSE(root.at("description").get<std::string>().empty());
  EXPECT_TRUE(is_moment(root.at("datePublished")));
  EXPECT_EQ(root.at("datePublished"), store_.run(history_.sheared).updated_at);
  EXPECT_TRUE(at(root.at("license")).contains("name"));
  EXPECT_TRUE(at(root.at("license")).contains("description"));
  const json& profile = at(root.at("conformsTo").at(0));
  EXPECT_EQ(profile.at("@id"), "https://w3id.org/ro/wfrun/process/0.5");
  EXPECT_EQ(profile.at("version"), "0.5");
}

TEST_F(Crate, EveryEntityHasATypeAndEveryReferenceLeadsSomewhere) {
  for (const auto& [id, entity] : entities_) {
    EXPECT_TRUE(entity.at("@type").is_string()) << id;
    for (const auto& [key, value] : entity.items()) {
      EXPECT_FALSE(value.is_object() && !value.contains("@id")) << id << "." << key << " is nested";
    }
    for_each_reference(entity, [&, &from = id](const std::string& to) {
      EXPECT_TRUE(entities_.contains(to) || to.starts_with("http")) << from << " -> " << to;
    });
  }
}

std::set<std::string> words(const std::string& text) {
  std::istringstream in(text);
  return {std::istream_iterator<std::string>(in), {}};
}

// Of schema.org 10.0, the context of RO-Crate 1.1; sha256 is from the workflow-run context.
TEST_F(Crate, UsesOnlyTermsOfItsContexts) {
  const auto terms = words(
      "@id @type about actionStatus conformsTo contentSize dateCreated datePublished description "
      "encodingFormat endTime error hasPart identifier instrument license location mentions name "
      "object result sha256 softwareRequirements softwareVersion startTime value version");
  const auto types =
      words("CreateAction CreativeWork Dataset File PropertyValue SoftwareApplication Place");
  for (const auto& [id, entity] : entities_) {
    EXPECT_TRUE(types.contains(entity.at("@type"))) << entity.at("@type");
    for (const auto& [key, value] : entity.items()) EXPECT_TRUE(terms.contains(key)) << key;
  }
}

TEST_F(Crate, EveryFileIsThereAsDescribedAndNoOther) {
  std::set<std::string> parts, present;
  for (const json& part : entities_.at("./").at("hasPart")) parts.insert(part.at("@id"));
  for (const json& file : of_type("File")) {
    const std::string id = file.at("@id");
    EXPECT_TRUE(parts.erase(id) == 1) << id << " is no part of the crate";
    EXPECT_TRUE(fs::path(id).is_relative() && id.find("..") == std::string::npos) << id;
    const std::string bytes = test::read_bytes(crate_ / id);
    EXPECT_EQ(file.at("contentSize"), std::to_string(bytes.size())) << id;
    EXPECT_EQ(file.at("sha256"), sha256_hex(bytes)) << id;
    EXPECT_TRUE(file.at("encodingFormat").is_string());
    present.insert(id);
  }
  EXPECT_TRUE(parts.empty()) << *parts.begin() << " is no File";
  present.insert("ro-crate-metadata.json");
  for (const auto& entry : fs::recursive_directory_iterator(crate_)) {
    if (entry.is_directory()) continue;
    EXPECT_EQ(present.erase(entry.path().lexically_relative(crate_).string()), 1U) << entry.path();
  }
  EXPECT_TRUE(present.empty());
  EXPECT_EQ(files_.size(), of_type("File").size() + 1);
  // One packing and three states; the rejected one is told of and not copied.
  EXPECT_EQ(test::read_bytes(crate_ / "manifests" / (sha256_hex("manifest") + ".yaml")),
            "manifest");
  EXPECT_FALSE(entities_.contains("checkpoints/" + history_.rejected + ".h5"));
  EXPECT_EQ(entities_.at("#checkpoint-" + history_.rejected).at("sha256"), history_.rejected);
}

TEST_F(Crate, OneActionForEachAttempt) {
  const std::vector<json> actions = of_type("CreateAction");
  EXPECT_EQ(actions.size(), 5U);
  EXPECT_EQ(entities_.at("./").at("mentions").size(), actions.size());
  std::map<std::string, int> statuses;
  for (const json& action : actions) {
    const json& tool = at(action.at("instrument"));
    EXPECT_EQ(tool.at("@type"), "SoftwareApplication");
    EXPECT_EQ(tool.at("name"), "shearcell");
    EXPECT_TRUE(tool.at("softwareVersion").get<std::string>().starts_with("0.1.0 ("));
    EXPECT_TRUE(is_moment(action.at("startTime")));
    const std::string status = action.at("actionStatus").at("@id");
    ++statuses[status];
    EXPECT_EQ(status == "http://schema.org/FailedActionStatus", action.contains("error"));
    for (const json& result : action.at("result")) EXPECT_TRUE(at(result).contains("sha256"));
  }
  EXPECT_EQ(statuses["http://schema.org/CompletedActionStatus"], 2);
  EXPECT_EQ(statuses["http://schema.org/FailedActionStatus"], 3);
  EXPECT_EQ(of_type("SoftwareApplication").size(), 2U) << "two builds";
  EXPECT_EQ(of_type("Place").size(), 1U) << "one host";
}

TEST_F(Crate, AnActionIsGivenManifestPackingSeedAndParameters) {
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
  EXPECT_EQ(values, (std::map<std::string, json>{
                        {"fluid", "cell"}, {"mass_kg", 2e-5}, {"seed", 7}, {"stage", "shear"}}));
}

TEST_F(Crate, ProvJsonDeclaresWhatItRelates) {
  const json prov = json::parse(test::read_bytes(crate_ / "prov.json"));
  const std::map<std::string, std::map<std::string, std::string>> relations = {
      {"used", {{"prov:activity", "activity"}, {"prov:entity", "entity"}}},
      {"wasGeneratedBy", {{"prov:activity", "activity"}, {"prov:entity", "entity"}}},
      {"wasAssociatedWith",
       {{"prov:activity", "activity"}, {"prov:agent", "agent"}, {"prov:plan", "entity"}}},
      {"wasDerivedFrom",
       {{"prov:generatedEntity", "entity"},
        {"prov:usedEntity", "entity"},
        {"prov:activity", "activity"}}}};
  const std::set<std::string> prefixes = {"prov", "xsd", "shearcell"};
  ASSERT_TRUE(prov.at("prefix").contains("shearcell"));
  for (const auto& [section, content] : prov.items()) {
    if (section == "prefix") continue;
    const bool relates = relations.contains(section);
    EXPECT_TRUE(relates || section == "entity" || section == "activity" || section == "agent");
    for (const auto& [id, facts] : content.items()) {
      EXPECT_TRUE(prefixes.contains(id.substr(0, id.find(':'))) || id.starts_with("_:")) << id;
      for (const auto& [key, value] : facts.items()) {
        EXPECT_TRUE(prefixes.contains(key.substr(0, key.find(':')))) << key;
        const auto target = relates ? relations.at(section).find(key)
                                    : std::map<std::string, std::string>::const_iterator{};
        if (relates && target != relations.at(section).end()) {
          EXPECT_TRUE(prov.at(target->second).contains(value.get<std::string>())) << value;
        }
      }
    }
  }
  EXPECT_EQ(prov.at("activity").size(), 5U);
  EXPECT_EQ(prov.at("agent").size(), 2U);
  EXPECT_EQ(prov.at("wasAssociatedWith").size(), 5U);
  std::map<std::string, int> generated;
  for (const json& g : prov.at("wasGeneratedBy")) ++generated[g.at("prov:entity")];
  EXPECT_EQ(generated.size(), 5U);
  for (const auto& [id, count] : generated) EXPECT_EQ(count, 1) << id;
}

TEST_F(Crate, EqualStoresGiveEqualBytes) {
  fs::copy(folder_.path() / "store", folder_.path() / "copy", fs::copy_options::recursive);
  const Store copy(folder_.path() / "copy", Access::read);
  for (const std::string& file :
       write_ro_crate(copy, history_.sheared, folder_.path() / "other/")) {
    EXPECT_EQ(test::read_bytes(crate_ / file), test::read_bytes(folder_.path() / "other" / file));
  }
}

TEST_F(Crate, AnEarlierExportIsBroughtUpToDateAndNothingElseIsTouched) {
  const fs::path damaged = crate_ / files_.front();
  test::write_bytes(damaged, "spoilt");
  test::write_bytes(crate_ / "notes.txt", "mine");
  EXPECT_EQ(write_ro_crate(store_, history_.sheared, crate_), files_);
  EXPECT_NE(test::read_bytes(damaged), "spoilt");
  EXPECT_EQ(test::read_bytes(crate_ / "notes.txt"), "mine");
  EXPECT_THROW(write_ro_crate(store_, history_.packing, crate_), std::invalid_argument);

  const fs::path foreign = folder_.path() / "foreign";
  fs::create_directory(foreign);
  test::write_bytes(foreign / "ro-crate-metadata.json", "{\"@graph\":[{\"@id\":\"./\"}, 3]}");
  EXPECT_THROW(write_ro_crate(store_, history_.sheared, foreign), std::invalid_argument);
  EXPECT_THROW(write_ro_crate(store_, history_.sheared, crate_ / "notes.txt"),
               std::invalid_argument);
  EXPECT_THROW(write_ro_crate(store_, history_.sheared, store_.folder()), std::invalid_argument);
}

TEST_F(Crate, FollowsNoLinkOutOfItsFolder) {
  const fs::path outside = folder_.path() / "outside";
  fs::create_directory(outside);
  fs::remove_all(crate_ / "checkpoints");
  fs::create_directory_symlink(outside, crate_ / "checkpoints");
  EXPECT_THROW(write_ro_crate(store_, history_.sheared, crate_), std::invalid_argument);
  EXPECT_TRUE(fs::is_empty(outside));
  fs::remove(crate_ / "checkpoints");
  fs::remove(crate_ / "prov.json");
  test::write_bytes(outside / "precious", "precious");
  fs::create_symlink(outside / "precious", crate_ / "prov.json");
  write_ro_crate(store_, history_.sheared, crate_);
  EXPECT_EQ(test::read_bytes(outside / "precious"), "precious");
  EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(crate_ / "prov.json")));
}

TEST_F(Crate, APrunedCheckpointIsToldOfAndNotCopied) {
  const CheckpointRecord record = store_.checkpoints(history_.sheared).at(1);
  fs::remove(store_.folder() / record.file);
  const fs::path pruned = folder_.path() / "pruned";
  EXPECT_THROW(write_ro_crate(store_, history_.sheared, pruned), StoreDamaged);
  test::append_to_run(store_, history_.sheared, events::encode(events::CheckpointPruned(record)));
  write_ro_crate(store_, history_.sheared, pruned);
  EXPECT_FALSE(fs::exists(pruned / crate_path_of_checkpoint(record.sha256)));
  const std::string metadata = test::read_bytes(pruned / "ro-crate-metadata.json");
  EXPECT_NE(metadata.find("#checkpoint-" + record.sha256), std::string::npos);
  test::append_to_run(store_, history_.sheared,
                      events::encode(events::CheckpointRegenerated(record)));
  EXPECT_FALSE(run_lineage(store_, history_.sheared).back().find(record.sha256)->pruned);
}

TEST_F(Crate, ADamagedCheckpointLeavesNoCrate) {
  const CheckpointRecord record = store_.checkpoints(history_.sheared).back();
  fs::resize_file(store_.folder() / record.file, 100);
  const fs::path fresh = folder_.path() / "fresh";
  const std::string message =
      test::message_of<StoreDamaged>([&] { write_ro_crate(store_, history_.sheared, fresh); });
  EXPECT_NE(message.find(record.file), std::string::npos) << message;
  std::size_t left = 0;
  for (const auto& entry : fs::directory_iterator(folder_.path())) {
    left += entry.path().filename().string().find("fresh") != std::string::npos ? 1 : 0;
  }
  EXPECT_EQ(left, 0U);
}

// A second reader, when there is one: Python's JSON, and its prov module.
TEST_F(Crate, PythonReadsIt) {
  // Debian's modules belong to the Python in /usr/bin.
  const std::string python = "PATH=/usr/bin:$PATH python3 ";
  if (std::system((python + "-c '' > /dev/null 2>&1").c_str()) != 0) GTEST_SKIP() << "no python3";
  const std::string command =
      python + SHEARCELL_TEST_DATA "/../provenance/check_crate.py '" + crate_.string() + "'";
  EXPECT_EQ(std::system(command.c_str()), 0);
}

}  // namespace
}  // namespace shearcell
