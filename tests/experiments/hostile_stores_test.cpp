// SPDX-License-Identifier: GPL-3.0-or-later
// Damaged and forged stores: message and exit code of each command, and what it does not change.
// hostile_forgeries_test.cpp has the forgeries that are consistent in themselves.
#include <gtest/gtest.h>

#include "tests/experiments/hostile.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;

const std::string kBackup = "from a backup";

std::vector<Case> damaged_logs() {
  const auto log = [](const auto& change) { return at("store.sqlite", change); };
  const std::string odd = "a folder, link or device";
  const Damage interrupted = [](const fs::path& store) {  // while the store was created
    fs::remove_all(store);
    fs::create_directories(store / "objects");
    write_bytes(store / "store.sqlite", "");
  };
  return {
      reported("log_cut_in_half", "status", 4, log(truncate_file), "damaged", kBackup),
      reported("log_empty", "status", 4, log(written("")), "the log is empty", kBackup),
      reported(
          "log_empty_with_folders_of_checkpoints", "verify", 2,
          [=](const fs::path& store) {
            interrupted(store);
            fs::create_directory(store / "objects/ab");
            write_bytes(store / "objects/ab/.tmp-99999999-0", "x");
            write_bytes(store / "derived.sqlite", "");
          },
          "creation of this store", "shearcell run"),
      reported(
          "log_empty_with_measures", "run m.yaml", 4,
          [=](const fs::path& store) {
            interrupted(store);
            write_bytes(store / "derived.sqlite", "x");
          },
          "the log is empty", kBackup),
      reported("log_empty_of_a_new_store", "verify", 2, interrupted, "creation of this store",
               "shearcell run"),
      reported("log_empty_of_a_new_store_that_run_completes", "run m.yaml --cycles 1", 0,
               interrupted, "3 stages computed"),
      reported("log_missing", "run m.yaml", 4, log(removed), "the log is missing", kBackup),
      reported("log_is_text", "status", 4, log(written(std::string(9999, 'x'))), "not a database",
               "from a backup"),
      reported("log_is_folder", "status", 4, log(folder_instead), odd, "remove it"),
      reported("log_is_link", "status", 4, log(link_instead), odd, "remove it"),
      reported("log_is_pipe", "verify", 4, log(pipe_instead), odd, "remove it"),
      reported("pages_overwritten", "verify", 4, log([](const fs::path& file) {
                 std::string bytes = read_bytes(file);
                 bytes.replace(bytes.size() / 4, bytes.size() / 2, bytes.size() / 2, '\x55');
                 write_bytes(file, bytes);
               }),
               "damaged", kBackup),
      reported("journal_of_garbage", "status", 0,
               at("store.sqlite-journal", written("not a journal")), "completed"),
      reported(
          "store_is_a_file", "status", 2,
          [](const fs::path& store) {
            fs::remove_all(store);
            write_bytes(store, "x");
          },
          "a store is a folder", "choose another path"),
      reported("store_is_missing", "status", 2, removed, "there is no store here", "shearcell run"),
      reported(
          "store_cannot_be_created", "run m.yaml", 1,
          [](const fs::path& store) {
            fs::remove_all(store);
            fs::create_symlink("/proc/nowhere/store", store);
          },
          "cannot create the store", "--store"),
      reported("of_another_program", "status", 4, sql("PRAGMA application_id=1"),
               "belongs to another program"),
      reported("newer_schema", "run m.yaml", 4, sql("PRAGMA user_version=99"), "schema 99",
               "use the newer shearcell"),
      reported("schema_that_never_was", "status", 4, sql("PRAGMA user_version=0"), "has schema 0",
               "from a backup"),
      reported("no_events", "verify", 4, sql("DROP TABLE events"), "no such table: events",
               kBackup),
      reported("no_runs", "status", 4, sql("PRAGMA foreign_keys=OFF; DROP TABLE runs"),
               "no such table: runs", kBackup),
      reported("view_for_a_table", "status", 4,
               sql("ALTER TABLE figures RENAME TO f; CREATE VIEW figures AS SELECT * FROM f"),
               "which is not part of schema", kBackup),
      reported("trigger_of_a_stranger", "run m.yaml", 4,
               sql("CREATE TRIGGER t AFTER INSERT ON events BEGIN DELETE FROM runs; END"), "'t'",
               "which is not part of schema", kBackup),
      reported("table_of_a_stranger", "verify", 4, sql("CREATE TABLE stranger(a)"), "'stranger'",
               kBackup),
      reported("statistics_for_the_planner", "verify", 0, sql("ANALYZE"), "nothing was changed"),
      reported("index_that_computes", "status", 4, sql("CREATE INDEX i ON runs(abs(grains))"),
               "'i'", kBackup),
      reported("value_of_70_MB", "status", 4,
               sql("UPDATE runs SET error = printf('%.*c', 70000000, 'x')"), "exceeds 64 MiB",
               kBackup),
  };
}

std::vector<Case> damaged_events() {
  const std::string deep =
      "{\"why\":" + std::string(200'000, '[') + std::string(200'000, ']') + "}";
  return {
      reported("payload_changed", "verify", 4,
               sql("UPDATE events SET payload = replace(payload, '\"seed\":1', '\"seed\":2')"),
               "does not match its content", "from a backup"),
      reported("payload_no_json", "rebuild", 4, forged([](Event& e) { e.payload = "{\"cut"; }),
               "is not a JSON object"),
      reported("payload_a_list", "log", 4, forged([](Event& e) { e.payload = "[1]"; }),
               "is not a JSON object"),
      reported("payload_nested_200000_deep", "verify", 4,
               forged([=](Event& e) { e.payload = deep; }), "nested too deeply"),
      reported("payload_nested_in_figures", "show tiny/base/S2a.csv", 4, forged([=](Event& e) {
                 if (e.type == "FigureGenerated") e.payload = deep;
               }),
               "nested too deeply"),
      reported("payload_of_a_newer_layout", "rebuild", 4, forged([](Event& e) { e.schema = 9; }),
               "layout 9", "use the newer shearcell"),
      reported("member_missing", "rebuild", 4,
               payload("RunDeclared", [](auto& b) { b.erase("target_cycles"); }), "RunDeclared",
               "target_cycles"),
      reported("member_of_another_type", "rebuild", 4,
               payload("RunDeclared", [](auto& b) { b["membership"] = 1; }), "RunDeclared"),
      reported("step_of_1e300", "rebuild", 4,
               payload("CheckpointRecorded", [](auto& b) { b["step"] = 1e300; }),
               "step must be a whole number"),
      reported("negative_size", "rebuild", 4,
               payload("CheckpointRecorded", [](auto& b) { b["size"] = -1; }),
               "size must be a whole number"),
      reported("unknown_parent", "rebuild", 4,
               payload("RunDeclared", [](auto& b) { b["parent"] = std::string(64, 'a'); }),
               "FOREIGN KEY", kBackup),
      reported("figure_of_an_unknown_run", "show tiny/base/S2a.csv", 4,
               payload("FigureGenerated", [](auto& b) { b["inputs"][0]["run"] = "x"; }),
               "the store has no run 'x'"),
      reported("figure_without_inputs", "show tiny/base/S2a.csv", 4,
               payload("FigureGenerated", [](auto& b) { b.erase("inputs"); }), "FigureGenerated"),
      reported("manifest_without_facts", "figures --all", 4,
               payload("ManifestRegistered", [](auto& b) { b.erase("info"); }),
               "ManifestRegistered", "info"),
      reported("manifest_of_another_text", "show tiny/base/S2a.csv", 4,
               payload("ManifestRegistered", [](auto& b) { b["text"] = "a: 1"; }),
               "the SHA-256 of its text differs"),
      reported(
          "parameters_of_another_run", "resume", 4,
          [](auto& s) {
            payload("RunDeclared", [](auto& b) {
              b["resolved"]["parameters"]["grains"] = 100'000'000;
              b["target_cycles"] = 5;
            })(s);
            Store(s, Access::write).rebuild();
          },
          "the id is not the hash of the recorded parameters",
          "stopped by damaged files in the store"),
  };
}

std::vector<Case> damaged_tables() {
  const std::string rebuild = "run `rebuild`", last = "seq = (SELECT max(seq) FROM events)";
  const auto lacks = [&](const char* name, const char* command, const std::string& rows) {
    return reported(name, command, 4, sql("PRAGMA foreign_keys = OFF; DELETE FROM " + rows),
                    "a derived table lacks a row of ", rebuild);
  };
  return {
      lacks("checkpoint_lacking", "table", "checkpoints WHERE cycle = 1"),
      lacks("checkpoint_lacking_in_the_status", "status", "checkpoints WHERE cycle = 1"),
      lacks("checkpoint_lacking_in_an_export", "export --to vtk --out e",
            "checkpoints WHERE step = (SELECT max(step) FROM checkpoints)"),
      lacks("membership_lacking", "status",
            "memberships WHERE ordinal = (SELECT max(ordinal) FROM "
            "memberships)"),
      lacks("run_lacking", "report", "runs WHERE kind = 'shear'"),
      lacks("run_lacking_with_all_its_rows", "table",
            "runs; DELETE FROM memberships; DELETE FROM checkpoints"),
      lacks("manifest_lacking", "figures S2", "manifests"),
      lacks("newest_lacking", "table", "newest"),
      reported("rows_lacking_until_rebuild", "rebuild", 0, sql("DELETE FROM checkpoints"),
               "rebuilt from"),
      reported("event_lacking", "status", 4, sql("DELETE FROM events WHERE seq = 3"),
               "events are missing in the log", "run `verify`"),
      reported("newest_event_changed", "table", 4,
               sql("UPDATE events SET recorded_at = '2000' WHERE " + last),
               "one of its fields was changed", "run `verify`"),
      reported("newest_event_of_another_chain", "status", 4,
               sql("UPDATE events SET prev_hash = hash WHERE " + last), "run `verify`"),
      reported("unknown_state", "status", 4, sql("UPDATE runs SET state = 'x'"),
               "unknown state 'x'", "run `rebuild`"),
      reported("labels_no_json", "status", 4, sql("UPDATE memberships SET labels = '{'"),
               "broken JSON", "run `rebuild`"),
      reported("labels_a_list", "figures S2", 0, sql("UPDATE memberships SET labels = '[1]'")),
      reported("resolved_a_number", "figures S2", 4, sql("UPDATE runs SET resolved = '1'"),
               "shearcell verify"),
      reported("resolved_a_number_in_a_report", "report", 4, sql("UPDATE runs SET resolved = '1'"),
               "shearcell verify"),
      reported(
          "pressure_a_text_in_a_report", "report", 0,
          sql("UPDATE runs SET resolved = json_set(resolved, '$.parameters.pressure_Pa', 'x')")),
      reported("table_not_of_the_events", "verify", 4, sql("UPDATE runs SET grains = 7"),
               "differs from the events", "run `rebuild`"),
      reported("leases_of_garbage", "status", 0,
               sql("INSERT INTO leases SELECT 'no-such-run', '', '', -1, -1, '', -1, -1, "
                   "9223372036854775807"),
               "completed"),
      reported("terminal_escapes", "status", 0,
               sql("UPDATE runs SET error = char(27) || ']0;owned' || char(7) || char(155)"),
               "\\x1b]0;owned\\x07\\x9b"),
      reported("terminal_escapes_in_a_figure", "figures S2", 4,
               sql("UPDATE memberships SET scale = char(27) || '[2J';"
                   "UPDATE newest SET scale = char(27) || '[2J'"),
               "'\\x1b[2J', which cannot be a folder name"),
      reported("measures_of_garbage", "figures S2", 0, at("derived.sqlite", written("garbage")),
               "/S2: "),
      reported("measures_nested_deeply", "figures S2", 0,
               measures("",
                        [](auto& m) {
                          for (int i = 0; i < 100; ++i) m = {m};
                        }),
               "4 of them newly measured"),
      reported("measures_in_a_folder", "figures S2", 0, at("derived.sqlite", folder_instead),
               "measures cannot be cached"),
      reported("measures_through_a_link", "figures S2", 0, at("derived.sqlite", link_instead),
               "measures cannot be cached", "move it to another place"),
  };
}

std::vector<Case> damaged_objects() {
  return {
      reported("object_removed", "verify", 4, object(removed), "the file is missing",
               "from a backup"),
      reported("object_cut_in_half", "verify", 4, object(truncate_file), "bytes instead of",
               "from a backup"),
      reported("object_of_zeros", "verify", 4,
               object([](auto& f) { write_bytes(f, std::string(fs::file_size(f), '\0')); }),
               "its SHA-256 is not the recorded one"),
      reported("object_with_holes_of_a_terabyte", "verify", 4,
               object([](auto& f) { fs::resize_file(f, std::uintmax_t{1} << 40); }),
               "it has 1099511627776 bytes instead of"),
      reported("object_is_link", "verify", 4, object(link_instead), "it is a symbolic link"),
      reported("object_is_folder", "verify", 4, object(folder_instead), "it is not a regular file"),
      reported("object_is_pipe", "verify", 4, object(pipe_instead), "it is not a regular file"),
      reported("objects_folder_is_file", "verify", 4, object([](auto& f) {
                 const fs::path d = f.parent_path();
                 fs::remove_all(d);
                 write_bytes(d, "x");
               }),
               "this must be a folder of the store", "remove it"),
      reported("objects_is_link", "verify", 4, at("objects", link_instead),
               "this must be a folder of the store"),
      reported("no_objects", "figures S2", 4, unmeasured(at("objects", removed)), "objects",
               "missing or empty"),
      reported("no_objects_to_continue_from", "run m.yaml --cycles 2", 4, at("objects", removed),
               "objects", "missing or empty"),
      reported("no_objects_of_a_reader", "verify", 4, at("objects", removed),
               "the file is missing"),
      reported("object_of_a_stranger", "verify", 0, at("objects/note.txt", written("x")),
               "no event refers to this file"),
      reported(
          "checkpoints_forged_text", "figures S2", 4,
          [](const fs::path& s) { forge_checkpoints(s, std::string(5000, 'x')); },
          "it is not HDF5"),
      reported(
          "checkpoints_forged_hdf5", "figures S2", 4,
          [](const fs::path& s) {
            std::string hdf5 = read_bytes(an_object(s)).substr(512);
            hdf5.replace(96 + 16, 64, 64, '\x10');
            forge_checkpoints(s, hdf5);
          },
          "left out: ", "checkpoint: "),
      reported("checkpoint_names_a_parent_folder", "verify", 4,
               payload("CheckpointRecorded", [](auto& b) { b["sha256"] = "../../../etc/passwd"; }),
               "is not a SHA-256"),
      reported("checkpoint_of_a_terabyte", "verify", 4,
               payload("CheckpointRecorded", [](auto& b) { b["size"] = std::uint64_t{1} << 40; }),
               "bytes instead of 1099511627776"),
  };
}

class DamagedStore : public HostileStore {};
TEST_P(DamagedStore, IsReportedWithItsExitCode) {
  expect_reported(GetParam());
}
INSTANTIATE_TEST_SUITE_P(Logs, DamagedStore, testing::ValuesIn(damaged_logs()), case_name);
INSTANTIATE_TEST_SUITE_P(Events, DamagedStore, testing::ValuesIn(damaged_events()), case_name);
INSTANTIATE_TEST_SUITE_P(Tables, DamagedStore, testing::ValuesIn(damaged_tables()), case_name);
INSTANTIATE_TEST_SUITE_P(Objects, DamagedStore, testing::ValuesIn(damaged_objects()), case_name);

}  // namespace
}  // namespace shearcell::test
