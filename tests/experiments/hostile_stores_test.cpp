// SPDX-License-Identifier: GPL-3.0-or-later
// Damaged and forged stores: what each command says of them, with what exit code, and what it
// leaves alone. Each case is one line of a table over copies of one small store.
#include <gtest/gtest.h>

#include <ostream>

#include "tests/experiments/damage.hpp"
#include "tests/experiments/program.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;

struct Case {
  const char* name;
  Damage damage;
  std::vector<std::string> command;
  int code;
  std::vector<std::string> says;  ///< on either stream
};

void PrintTo(const Case& damaged, std::ostream* out) {
  *out << damaged.name;
}

const std::string kBackup = "restore it from a backup";

std::vector<Case> damaged_logs() {
  const auto log = [](const fs::path& store) { return store / "store.sqlite"; };
  return {
      {"log_cut_in_half",
       [=](auto& s) { truncate_file(log(s)); },
       {"status"},
       4,
       {"damaged", kBackup}},
      {"log_empty",
       [=](auto& s) { write_file(log(s), ""); },
       {"status"},
       4,
       {"the log is empty", kBackup}},
      {"log_missing",
       [=](auto& s) { fs::remove(log(s)); },
       {"run", "m.yaml"},
       4,
       {"the log is lost", kBackup}},
      {"log_is_text",
       [=](auto& s) { write_file(log(s), std::string(9999, 'x')); },
       {"status"},
       4,
       {"not an SQLite database", "from a backup"}},
      {"log_is_folder",
       [=](auto& s) { folder_instead(log(s)); },
       {"status"},
       4,
       {"a folder, link or device", "remove it"}},
      {"log_is_link",
       [=](auto& s) { link_instead(log(s)); },
       {"status"},
       4,
       {"a folder, link or device", "remove it"}},
      {"log_is_pipe",
       [=](auto& s) { pipe_instead(log(s)); },
       {"verify"},
       4,
       {"a folder, link or device", "remove it"}},
      {"pages_overwritten",
       [=](auto& s) {
         std::string bytes = read_bytes(log(s));
         bytes.replace(bytes.size() / 4, bytes.size() / 2, bytes.size() / 2, '\x55');
         write_file(log(s), bytes);
       },
       {"verify"},
       4,
       {"damaged", kBackup}},
      {"journal_of_garbage",
       [](auto& s) { write_file(s / "store.sqlite-journal", "not a journal"); },
       {"status"},
       0,
       {"completed"}},
      {"store_is_a_file",
       [](auto& s) {
         fs::remove_all(s);
         write_file(s, "x");
       },
       {"status"},
       4,
       {"a store is a folder", "name another store"}},
      {"store_is_missing",
       [](auto& s) { fs::remove_all(s); },
       {"status"},
       2,
       {"there is no store here", "shearcell run"}},
      {"of_another_program",
       sql("PRAGMA application_id=1"),
       {"status"},
       4,
       {"belongs to another program"}},
      {"newer_schema",
       sql("PRAGMA user_version=99"),
       {"run", "m.yaml"},
       4,
       {"schema 99", "use the newer shearcell"}},
      {"schema_that_never_was",
       sql("PRAGMA user_version=0"),
       {"status"},
       4,
       {"never existed", "from a backup"}},
      {"no_events", sql("DROP TABLE events"), {"verify"}, 4, {"no such table: events", kBackup}},
      {"no_runs",
       sql("PRAGMA foreign_keys=OFF; DROP TABLE runs"),
       {"status"},
       4,
       {"no such table: runs", kBackup}},
      {"view_for_a_table",
       sql("ALTER TABLE figures RENAME TO f; CREATE VIEW figures AS SELECT * FROM f"),
       {"status"},
       4,
       {"which no store of schema", kBackup}},
      {"trigger_of_a_stranger",
       sql("CREATE TRIGGER t AFTER INSERT ON events BEGIN DELETE FROM runs; END"),
       {"run", "m.yaml"},
       4,
       {"'t'", "which no store of schema", kBackup}},
      {"table_of_a_stranger",
       sql("CREATE TABLE stranger(a)"),
       {"verify"},
       4,
       {"'stranger'", kBackup}},
      {"statistics_for_the_planner", sql("ANALYZE"), {"verify"}, 0, {"all as it was written"}},
      {"index_that_computes",
       sql("CREATE INDEX i ON runs(abs(grains))"),
       {"status"},
       4,
       {"'i'", kBackup}},
      {"value_of_70_MB",
       sql("UPDATE runs SET error = printf('%.*c', 70000000, 'x')"),
       {"status"},
       4,
       {"larger than 64 MiB", kBackup}},
  };
}

std::vector<Case> damaged_events() {
  const std::string deep =
      "{\"why\":" + std::string(200'000, '[') + std::string(200'000, ']') + "}";
  return {
      {"hash_flipped",
       sql("UPDATE events SET hash = 'f' || substr(hash, 2) WHERE seq = 2 AND hash NOT LIKE 'f%'; "
           "UPDATE events SET hash = '0' || substr(hash, 2) WHERE seq = 3"),
       {"verify"},
       4,
       {"event ", "was changed", "from a backup"}},
      {"payload_changed",
       sql("UPDATE events SET payload = replace(payload, '\"seed\":1', '\"seed\":2')"),
       {"verify"},
       4,
       {"does not fit its content", "from a backup"}},
      {"event_removed",
       sql("DELETE FROM events WHERE seq = 3"),
       {"verify"},
       4,
       {"event 3 should stand here and is missing"}},
      {"events_swapped",
       sql("UPDATE events SET seq = -1 WHERE seq = 2; UPDATE events SET seq = 2 WHERE seq = 3; "
           "UPDATE events SET seq = 3 WHERE seq = -1"),
       {"verify"},
       4,
       {"event 2"}},
      {"payload_no_json",
       forged([](Event& e) { e.payload = "{\"cut"; }),
       {"rebuild"},
       4,
       {"is not a JSON object"}},
      {"payload_a_list",
       forged([](Event& e) { e.payload = "[1]"; }),
       {"log"},
       4,
       {"is not a JSON object"}},
      {"payload_nested_200000_deep",
       forged([=](Event& e) { e.payload = deep; }),
       {"verify"},
       4,
       {"nested too deeply"}},
      {"payload_nested_in_figures",
       forged([=](Event& e) {
         if (e.type == "FigureGenerated") e.payload = deep;
       }),
       {"show", "S2a.csv"},
       4,
       {"nested too deeply"}},
      {"payload_of_a_newer_layout",
       forged([](Event& e) { e.schema = 9; }),
       {"rebuild"},
       4,
       {"layout 9", "use the newer shearcell"}},
      {"member_missing",
       payload("RunDeclared", [](auto& b) { b.erase("target_cycles"); }),
       {"rebuild"},
       4,
       {"RunDeclared", "target_cycles"}},
      {"member_of_another_type",
       payload("RunDeclared", [](auto& b) { b["membership"] = 1; }),
       {"rebuild"},
       4,
       {"RunDeclared"}},
      {"step_of_1e300",
       payload("CheckpointRecorded", [](auto& b) { b["step"] = 1e300; }),
       {"rebuild"},
       4,
       {"step must be a whole number"}},
      {"negative_size",
       payload("CheckpointRecorded", [](auto& b) { b["size"] = -1; }),
       {"rebuild"},
       4,
       {"size must be a whole number"}},
      {"unknown_parent",
       payload("RunDeclared", [](auto& b) { b["parent"] = std::string(64, 'a'); }),
       {"rebuild"},
       4,
       {"FOREIGN KEY", kBackup}},
      {"figure_of_an_unknown_run",
       payload("FigureGenerated", [](auto& b) { b["inputs"][0]["run"] = "x"; }),
       {"show", "S2a.csv"},
       4,
       {"the store has no run 'x'"}},
      {"figure_without_inputs",
       payload("FigureGenerated", [](auto& b) { b.erase("inputs"); }),
       {"show", "S2a.csv"},
       4,
       {"FigureGenerated"}},
      {"manifest_without_facts",
       payload("ManifestRegistered", [](auto& b) { b.erase("info"); }),
       {"figures", "--all"},
       4,
       {"ManifestRegistered", "info"}},
      {"manifest_of_another_text",
       payload("ManifestRegistered", [](auto& b) { b["text"] = "a: 1"; }),
       {"show", "S2a.csv"},
       4,
       {"has another SHA-256"}},
      {"parameters_of_another_run",
       [](auto& s) {
         payload("RunDeclared", [](auto& b) {
           b["resolved"]["parameters"]["grains"] = 100'000'000;
           b["target_cycles"] = 5;
         })(s);
         Store(s, Access::write).rebuild();
       },
       {"resume"},
       4,
       {"are not those that it is named after"}},
  };
}

std::vector<Case> damaged_tables() {
  return {
      {"unknown_state",
       sql("UPDATE runs SET state = 'x'"),
       {"status"},
       4,
       {"unknown state 'x'", "run `rebuild`"}},
      {"labels_no_json",
       sql("UPDATE memberships SET labels = '{'"),
       {"status"},
       4,
       {"broken JSON", "run `rebuild`"}},
      {"labels_a_list", sql("UPDATE memberships SET labels = '[1]'"), {"figures", "S2"}, 0, {}},
      {"resolved_a_number",
       sql("UPDATE runs SET resolved = '1'"),
       {"figures", "S2"},
       4,
       {"shearcell verify"}},
      {"table_not_of_the_events",
       sql("UPDATE runs SET grains = 7"),
       {"verify"},
       4,
       {"not what the events give", "run `rebuild`"}},
      {"leases_of_garbage",
       sql("INSERT INTO leases SELECT 'no-such-run', '', '', -1, -1, '', -1, -1, "
           "9223372036854775807"),
       {"status"},
       0,
       {"completed"}},
      {"terminal_escapes",
       sql("UPDATE runs SET error = char(27) || ']0;owned' || char(7) || char(155)"),
       {"status"},
       0,
       {"\\x1b]0;owned\\x07\\x9b"}},
      {"terminal_escapes_in_a_figure",
       sql("UPDATE memberships SET scale = char(27) || '[2J'"),
       {"figures", "S2"},
       0,
       {"S2 (\\x1b[2J scale)"}},
      {"measures_of_garbage",
       [](auto& s) { write_file(s / "derived.sqlite", "garbage"); },
       {"figures", "S2"},
       0,
       {"S2 ("}},
      {"measures_forged", forge_measures, {"figures", "S2"}, 0, {"4 of them measured now"}},
      {"measures_in_a_folder",
       [](auto& s) { folder_instead(s / "derived.sqlite"); },
       {"figures", "S2"},
       0,
       {"measures cannot be kept"}},
      {"measures_through_a_link",
       [](auto& s) {
         fs::rename(s / "derived.sqlite", s / "x");
         fs::create_symlink(s / "x", s / "derived.sqlite");
       },
       {"figures", "S2"},
       0,
       {"measures cannot be kept", "remove it"}},
  };
}

std::vector<Case> damaged_objects() {
  const std::vector<std::string> fresh = {"figures", "S2", "--fresh"};
  return {
      {"object_removed",
       object([](auto& f) { fs::remove(f); }),
       {"verify"},
       4,
       {"the file is missing", "from a backup"}},
      {"object_cut_in_half",
       object([](auto& f) { truncate_file(f); }),
       {"verify"},
       4,
       {"bytes instead of", "from a backup"}},
      {"object_of_zeros",
       object([](auto& f) { write_file(f, std::string(fs::file_size(f), '\0')); }),
       {"verify"},
       4,
       {"its SHA-256 is not the recorded one"}},
      {"object_with_holes_of_a_terabyte",
       object([](auto& f) { fs::resize_file(f, std::uintmax_t{1} << 40); }),
       {"verify"},
       4,
       {"it has 1099511627776 bytes instead of"}},
      {"object_is_link",
       object(link_instead),
       {"verify"},
       4,
       {"a symbolic link stands in its place"}},
      {"object_is_folder", object(folder_instead), {"verify"}, 4, {"it is not a regular file"}},
      {"object_is_pipe", object(pipe_instead), {"verify"}, 4, {"it is not a regular file"}},
      {"objects_folder_is_file",
       object([](auto& f) {
         const fs::path d = f.parent_path();
         fs::remove_all(d);
         write_file(d, "x");
       }),
       {"verify"},
       4,
       {"a folder of the store should stand here", "remove it"}},
      {"objects_is_link",
       [](auto& s) { link_instead(s / "objects"); },
       {"verify"},
       4,
       {"a folder of the store should stand here"}},
      {"no_objects",
       [](auto& s) { fs::remove_all(s / "objects"); },
       fresh,
       4,
       {"left out: ", "the file is missing"}},
      {"object_of_a_stranger",
       [](auto& s) { write_file(s / "objects" / "note.txt", "x"); },
       {"verify"},
       0,
       {"no event names this file"}},
      {"checkpoints_forged_text",
       [](auto& s) { forge_checkpoints(s, std::string(5000, 'x')); },
       fresh,
       4,
       {"it is no HDF5"}},
      {"checkpoints_forged_hdf5",
       [](auto& s) {
         std::string hdf5 = read_bytes(an_object(s)).substr(512);
         hdf5.replace(96 + 16, 64, 64, '\x10');  // the root group's messages
         forge_checkpoints(s, hdf5);
       },
       fresh,
       4,
       {"left out: ", "checkpoint: "}},
      {"checkpoint_names_a_parent_folder",
       payload("CheckpointRecorded", [](auto& b) { b["sha256"] = "../../../etc/passwd"; }),
       {"verify"},
       4,
       {"no SHA-256"}},
      {"checkpoint_of_a_terabyte",
       payload("CheckpointRecorded", [](auto& b) { b["size"] = std::uint64_t{1} << 40; }),
       {"verify"},
       4,
       {"bytes instead of 1099511627776"}},
  };
}

/// One store and one figure, made once and copied for each case.
class HostileStore : public ProgramTest, public testing::WithParamInterface<Case> {
 protected:
  void SetUp() override {
    write("m.yaml", tiny_manifest("  grains: 200\n", kBothFluids));
    static const TemporaryFolder kept;
    if (!fs::exists(kept.path() / "store")) {
      ASSERT_EQ(run({"run", "m.yaml", "--cycles", "1", "-q"}).code, 0);
      ASSERT_EQ(run({"figures", "S2", "--out", "figures"}).code, 0);
      fs::copy(path("shearcell-store"), kept.path() / "store", fs::copy_options::recursive);
      fs::copy(path("figures/S2a.csv"), kept.path() / "S2a.csv");
      fs::remove_all(path("figures"));
    } else {
      fs::copy(kept.path() / "store", path("shearcell-store"), fs::copy_options::recursive);
    }
    fs::copy(kept.path() / "S2a.csv", path("S2a.csv"));
  }
};

TEST_P(HostileStore, IsToldWithItsExitCode) {
  const Case& damaged = GetParam();
  damaged.damage(path("shearcell-store"));
  const Outcome outcome = run(damaged.command);
  const std::string said = outcome.out + outcome.err;
  EXPECT_EQ(outcome.signal, 0);
  EXPECT_EQ(outcome.code, damaged.code) << said.substr(0, 2000);
  for (const std::string& words : damaged.says) {
    EXPECT_NE(said.find(words), std::string::npos) << words << "\n" << said.substr(0, 2000);
  }
  EXPECT_EQ(said.find('\x1b'), std::string::npos);
}

const auto case_name = [](const auto& damaged) { return std::string(damaged.param.name); };
INSTANTIATE_TEST_SUITE_P(Logs, HostileStore, testing::ValuesIn(damaged_logs()), case_name);
INSTANTIATE_TEST_SUITE_P(Events, HostileStore, testing::ValuesIn(damaged_events()), case_name);
INSTANTIATE_TEST_SUITE_P(Tables, HostileStore, testing::ValuesIn(damaged_tables()), case_name);
INSTANTIATE_TEST_SUITE_P(Objects, HostileStore, testing::ValuesIn(damaged_objects()), case_name);

}  // namespace
}  // namespace shearcell::test
