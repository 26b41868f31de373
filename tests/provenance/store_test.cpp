// SPDX-License-Identifier: GPL-3.0-or-later
// The store records what happened to each run, for all threads and processes, now and later.
#include "provenance/store.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <optional>

#include "core/threads.hpp"
#include "provenance/derived.hpp"
#include "provenance/errors.hpp"
#include "provenance/io/clock.hpp"
#include "provenance/io/file.hpp"
#include "tests/provenance/samples.hpp"

namespace shearcell {
namespace {

namespace fs = std::filesystem;
using namespace test;  // NOLINT(google-build-using-namespace): the helpers of these tests

class StoreTest : public ::testing::Test {
 protected:
  StoreTest() { store_.declare_stage(sample_run(1)); }

  Store open(Access access = Access::create) const { return Store(path_, access); }

  std::vector<std::string> types(const std::string& stream) const {
    std::vector<std::string> found;
    for (const Event& event : store_.events(stream)) found.push_back(event.type);
    return found;
  }

  TemporaryFolder folder_;
  const fs::path path_ = folder_.path() / "store";
  const std::string id_ = run_id(1);
  Store store_{path_, Access::create};  ///< with run 1 declared
};

TEST_F(StoreTest, IsNotMixedWithOtherFiles) {
  const fs::path other = folder_.path() / "other";
  fs::create_directory(other);
  write_bytes(other / ".hidden", "");
  EXPECT_NO_THROW(Store(other, Access::create)) << "as empty";
  EXPECT_NO_THROW(Store(other, Access::create)) << "a store";
  expect_refused<UsageError>([&] { Store(folder_.path(), Access::create); },
                             {"not a store and has other files", "new or empty folder"});
}

TEST_F(StoreTest, FollowsARunFromItsDeclarationToItsEnd) {
  EXPECT_EQ(store_.stage(id_).state, StageState::declared);
  EXPECT_EQ(store_.start_stage(id_, {{"cpu", "test"}}), 1u);
  EXPECT_EQ(store_.stage(id_).state, StageState::running);
  const Checkpoint c = sample_checkpoint(id_, 45600);
  const CheckpointRecord record =
      store_.record_checkpoint(id_, c, {.wall_seconds = 2.5, .particle_steps = 912000});
  EXPECT_EQ(record.state_hash, state_hash(c));
  EXPECT_EQ(record.step, 45600u);
  EXPECT_EQ(record.observables, c.observables);
  EXPECT_EQ(fs::file_size(path_ / record.file), record.size);
  store_.complete_stage(id_);

  const Stage run = store_.stage(id_);
  EXPECT_EQ(run.state, StageState::completed);
  EXPECT_EQ(run.cycle, 1);
  EXPECT_EQ(run.step, 45600u);
  EXPECT_EQ(run.state_hash, record.state_hash);
  EXPECT_EQ(run.wall_seconds, 2.5);
  EXPECT_EQ(run.particle_steps, 912000);
  EXPECT_EQ(run.attempts, 1u);
  EXPECT_EQ(run.resolved, sample_run(1).resolved);
  ASSERT_EQ(run.memberships.size(), 1u);
  EXPECT_EQ(run.memberships[0].place.seed, sample_run(1).memberships[0].place.seed);
  EXPECT_EQ(run.memberships[0].ask.target_cycles, 5u);
  EXPECT_EQ(types("run/" + id_), (std::vector<std::string>{"RunDeclared", "RunStarted",
                                                           "CheckpointRecorded", "RunCompleted"}));
  EXPECT_TRUE(store_.verify().ok());
}

TEST_F(StoreTest, IsTheSameWhenOpenedAgain) {
  {
    Store killed = open();
    killed.start_stage(id_, {});
    killed.record_checkpoint(id_, sample_checkpoint(id_));
  }
  EXPECT_EQ(store_.stage(id_).state, StageState::running);
  const auto newest = store_.newest_valid_checkpoint(id_);
  ASSERT_TRUE(newest.has_value());
  EXPECT_EQ(state_hash(newest->checkpoint), state_hash(sample_checkpoint(id_)));
  EXPECT_EQ(store_.start_stage(id_, {}, newest->record.sha256), 2u);
  const Event resumed = store_.events("run/" + id_).back();
  EXPECT_EQ(resumed.type, "RunResumed");
  EXPECT_EQ(resumed.body()["from"]["sha256"], newest->record.sha256);
  EXPECT_EQ(resumed.body()["attempt"], 2);
}

TEST_F(StoreTest, KeepsAManifestOnce) {
  const std::string sha256 = store_.register_manifest("a: 1\n", "a.yaml", {{"name", "a"}});
  EXPECT_EQ(store_.register_manifest("a: 1\n", "b.yaml", {}), sha256);
  const std::vector<Event> events = store_.events("manifest/" + sha256);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].body()["text"], "a: 1\n");
}

TEST_F(StoreTest, RecordsADeclarationOnlyIfItIsNew) {
  Stage d = sample_run(1);
  store_.declare_stage(d);
  EXPECT_EQ(store_.events().size(), 1u);
  d.memberships[0].ask.target_cycles = 3;  // less than what is declared
  store_.declare_stage(d);
  EXPECT_EQ(store_.events().size(), 1u);
  d.memberships[0].place.experiment = "other";
  store_.declare_stage(d);
  EXPECT_EQ(store_.stage(id_).memberships.size(), 2u);
  EXPECT_EQ(store_.stage(id_).memberships[1].ask.target_cycles, 3u);
  EXPECT_EQ(store_.stage(id_).target_cycles, 5u);
  d.resolved["drag"] = "cell";
  EXPECT_THROW(store_.declare_stage(d), std::invalid_argument);
  d.id = "run 1";
  EXPECT_THROW(store_.declare_stage(d), std::invalid_argument);
  Stage orphan = sample_run(2);
  orphan.parent = run_id(99);
  EXPECT_THROW(store_.declare_stage(orphan), std::invalid_argument);
}

TEST_F(StoreTest, ALongerTargetReopensACompletedRun) {
  store_.start_stage(id_, {});
  store_.complete_stage(id_);
  EXPECT_THROW(store_.start_stage(id_, {}), ConcurrencyConflict);
  store_.declare_stage(sample_run(1, 8));
  EXPECT_EQ(store_.stage(id_).state, StageState::declared);
  EXPECT_EQ(store_.stage(id_).target_cycles, 8u);
  EXPECT_EQ(store_.stage(id_).memberships.size(), 1u);
  EXPECT_EQ(store_.stage(id_).memberships[0].ask.target_cycles, 8u);
  EXPECT_EQ(store_.start_stage(id_, {}), 2u);
}

TEST_F(StoreTest, ReportsWhyARunStopped) {
  store_.start_stage(id_, {});
  store_.interrupt_stage(id_, "SIGINT");
  EXPECT_EQ(store_.stage(id_).state, StageState::interrupted);
  EXPECT_EQ(store_.stage(id_).error, "SIGINT");
  store_.start_stage(id_, {});
  EXPECT_EQ(store_.stage(id_).error, "");
  store_.fail_stage(id_, "an overlap of 0.3 d", {{"overlap_d", 0.3}});
  EXPECT_EQ(store_.stage(id_).state, StageState::failed);
  EXPECT_EQ(store_.stage(id_).error, "an overlap of 0.3 d");
}

TEST_F(StoreTest, ANewMembershipDoesNotStopARunner) {
  store_.start_stage(id_, {});
  Stage shared = sample_run(1);
  shared.memberships[0].place.experiment = "other";
  open().declare_stage(shared);
  store_.record_checkpoint(id_, sample_checkpoint(id_));
  store_.complete_stage(id_);
  EXPECT_TRUE(store_.verify().ok());
}

TEST_F(StoreTest, RecordsTheSameCheckpointOnce) {
  const Checkpoint c = sample_checkpoint(id_);
  EXPECT_THROW(store_.record_checkpoint(id_, c), ConcurrencyConflict);  // no program holds the run
  store_.start_stage(id_, {});
  const CheckpointRecord once = store_.record_checkpoint(id_, c);
  EXPECT_EQ(store_.record_checkpoint(id_, c).seq, once.seq);
  EXPECT_EQ(store_.checkpoints(id_).size(), 1u);
  EXPECT_THROW(store_.record_checkpoint(id_, sample_checkpoint(run_id(2))), std::invalid_argument);
}

TEST_F(StoreTest, SkipsADamagedNewestCheckpoint) {
  store_.start_stage(id_, {});
  const auto first = store_.record_checkpoint(id_, sample_checkpoint(id_, 45600));
  const auto second = store_.record_checkpoint(id_, sample_checkpoint(id_, 91200));
  const auto third = store_.record_checkpoint(id_, sample_checkpoint(id_, 136800));
  store_.interrupt_stage(id_, "SIGTERM");
  fs::resize_file(path_ / third.file, third.size / 2);
  fs::remove(path_ / second.file);

  Store reader = open(Access::read);
  EXPECT_EQ(reader.newest_valid_checkpoint(id_)->record.sha256, first.sha256);
  EXPECT_EQ(reader.checkpoints(id_).size(), 3u);

  EXPECT_EQ(store_.newest_valid_checkpoint(id_).value().record.sha256, first.sha256);
  EXPECT_EQ(store_.checkpoints(id_).size(), 3u) << "rejected where the caller asks what is damaged";
  EXPECT_FALSE(store_.newest_valid_checkpoint(id_, nullptr, 45600).has_value());

  std::vector<std::string> damage;
  EXPECT_EQ(store_.newest_valid_checkpoint(id_, &damage).value().record.sha256, first.sha256);
  EXPECT_EQ(damage.size(), 2u);
  EXPECT_EQ(store_.checkpoints(id_).size(), 1u);
  EXPECT_EQ(store_.checkpoints(id_, Listed::all).size(), 3u);
  EXPECT_EQ(store_.stage(id_).step, 45600u);
  EXPECT_EQ(types("run/" + id_).back(), "CheckpointRejected");

  store_.start_stage(id_, {}, first.sha256);
  store_.record_checkpoint(id_, sample_checkpoint(id_, 91200));  // computed again
  EXPECT_EQ(store_.newest_valid_checkpoint(id_)->record.sha256, second.sha256);
  EXPECT_EQ(store_.stage(id_).step, 91200u);
}

TEST_F(StoreTest, TheManifestRegisteredLastIsTheNewestEvenIfTheClockWentBack) {
  const nlohmann::json info = {{"experiment", "a"}};
  store_.register_manifest("a: 1\n", "a.yaml", info);
  sqlite::Database(path_ / "store.sqlite", Access::write)
      .execute(
          "DROP TRIGGER events_are_never_updated; UPDATE events SET recorded_at = "
          "'2999-01-01T00:00:00.000Z' WHERE type = 'ManifestRegistered'");
  store_.register_manifest("a: 2\n", "a.yaml", info);
  store_.register_manifest("a: 2\n", "a.yaml", info);  // adds nothing
  const auto registered = store_.events("", "ManifestRegistered");
  ASSERT_EQ(registered.size(), 2U);
  EXPECT_EQ(registered[1].recorded_at, registered[0].recorded_at);
}

TEST_F(StoreTest, ListsCheckpointsInATimeIndependentOfTheNumberOfRuns) {
  sqlite::Database database(path_ / "store.sqlite", Access::write);
  database.execute(
      "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 50000) INSERT "
      "INTO runs(id, ordinal, kind, resolved, state, grains, target_cycles, updated_at) SELECT "
      "printf('0%063x', i), 100 + i, 'shear', '{}', 'declared', 1, 1, '' FROM n");
  const auto seconds_of_100 = [](auto&& read) {
    const Stopwatch watch;
    for (int i = 0; i < 100; ++i) read();
    return watch.seconds();
  };
  store_.checkpoints(id_);  // the first read checks the tables
  const double listed = seconds_of_100([&] { EXPECT_TRUE(store_.checkpoints(id_).empty()); });
  const double every_run = seconds_of_100([&] {
    database.execute("UPDATE runs SET grains = 1 WHERE grains = 2");  // reads every run
  });
  EXPECT_LT(listed, every_run / 2);
}

TEST_F(StoreTest, FindsARunByItsPrefix) {
  for (int i = 0; i < 40; ++i) store_.declare_stage(sample_run(i));
  EXPECT_EQ(store_.find_stage(run_id(7).substr(0, 12)).id, run_id(7));
  expect_refused<NotFound>([&] { store_.find_stage(""); }, {"several runs", "\n  ..."});
  EXPECT_THROW(store_.find_stage("xyz"), NotFound);
  EXPECT_THROW(store_.find_stage("%"), NotFound);
  EXPECT_THROW(store_.stage(run_id(7).substr(0, 12)), NotFound);
  EXPECT_EQ(store_.stages().size(), 40u);
  EXPECT_EQ(store_.stages()[7].id, run_id(7));
}

TEST_F(StoreTest, KeepsTheNewestRecordOfEachFigure) {
  store_.record("figure/S2a", {"FigureGenerated", {{"inputs", {1}}}});
  store_.record("figure/S2b", {"FigureGenerated", {{"inputs", {2}}}});
  store_.record("figure/S2a", {"FigureGenerated", {{"inputs", {3}}}});
  const std::vector<FigureRecord> figures = store_.figures();
  ASSERT_EQ(figures.size(), 2u);
  EXPECT_EQ(figures[0].name, "S2a");
  EXPECT_EQ(figures[0].provenance["inputs"][0], 3);
  EXPECT_EQ(store_.events("figure/S2a").size(), 2u);
}

TEST_F(StoreTest, RejectsARecordThatItCouldNotReadAgain) {
  EXPECT_THROW(
      store_.record("figure/S2a", {"FigureGenerated", {{"inputs", std::string(65 << 20, 'x')}}}),
      UsageError);
  store_.record("figure/S2b", {"FigureGenerated", {{"inputs", {2}}}});
  EXPECT_EQ(open().figures().size(), 1u);
}

TEST_F(StoreTest, AcceptsRecordsFromManyThreadsAndProcesses) {
  constexpr int kRuns = 8;
  start_threads(1 + kRuns, [this](std::size_t thread) {
    const int i = 1 + static_cast<int>(thread);
    std::optional<Store> own;  // a connection of its own, as another process has
    if (i % 2 == 0) own.emplace(path_, Access::write);
    Store& store = own ? *own : store_;
    store.declare_stage(sample_run(i));
    store.start_stage(run_id(i), {});
    for (std::uint64_t step = 0; step < 5; ++step) {
      store.record_checkpoint(run_id(i), sample_checkpoint(run_id(i), step));
      store.stages();
    }
    store.complete_stage(run_id(i));
  });
  for (int i = 2; i < 2 + kRuns; ++i) {
    EXPECT_EQ(store_.stage(run_id(i)).state, StageState::completed);
  }
  const VerifyReport report = store_.verify();
  EXPECT_TRUE(report.ok());
  EXPECT_EQ(report.checkpoints, 5u * kRuns);
}

TEST_F(StoreTest, AReaderChangesNothing) {
  const std::string before = read_bytes(path_ / "store.sqlite");
  Store reader = open(Access::read);
  EXPECT_THROW(reader.declare_stage(sample_run(2)), std::logic_error);
  EXPECT_THROW(reader.start_stage(id_, {}), std::logic_error);
  EXPECT_THROW(reader.rebuild(), std::logic_error);
  EXPECT_EQ(reader.stages().size(), 1u);
  EXPECT_TRUE(reader.verify().ok());
  EXPECT_EQ(read_bytes(path_ / "store.sqlite"), before);
}

TEST_F(StoreTest, CanBeCreatedAfterAnInterruptedCreation) {
  const fs::path other = folder_.path() / "other";
  fs::create_directories(other);
  write_bytes(other / "store.sqlite", "");
  Store store(other, Access::create);
  store.declare_stage(sample_run(1));
  EXPECT_TRUE(store.verify().ok());
}

// A killed program leaves no log without tables: until the log is whole it has another name.
TEST_F(StoreTest, TheLogIsWholeWhenItHasItsName) {
  for (int attempt = 0; attempt < 20; ++attempt) {
    const fs::path folder = folder_.path() / std::to_string(attempt);
    const pid_t child = fork();
    if (child == 0) {
      Store(folder, Access::create);
      _exit(0);
    }
    for (;;) {  // as soon as there is a file of this name
      if (fs::exists(folder / "store.sqlite")) break;
    }
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    EXPECT_TRUE(Store(folder, Access::read).verify().ok());
  }
}

TEST_F(StoreTest, FilesHaveThePermissionsOfTheUmask) {
  const auto mode = [](const fs::path& path) {
    return static_cast<unsigned>(fs::status(path).permissions());
  };
  for (const mode_t mask : {mode_t{002}, mode_t{022}, mode_t{077}}) {
    const mode_t before = umask(mask);
    const fs::path folder = folder_.path() / std::to_string(mask);
    Store store(folder, Access::create);
    store.declare_stage(sample_run(1));
    store.start_stage(id_, {});
    const CheckpointRecord record = store.record_checkpoint(id_, sample_checkpoint(id_));
    DerivedCache cache(folder);
    umask(before);
    for (const fs::path& file :
         {folder / "store.sqlite", folder / DerivedCache::kFile, folder / record.file}) {
      EXPECT_EQ(mode(file), 0666 & ~mask) << file;
    }
    for (const fs::path& path :
         {folder, folder / "objects", (folder / record.file).parent_path()}) {
      EXPECT_EQ(mode(path), 0777 & ~mask) << path;
    }
  }
}

TEST_F(StoreTest, DeletesTemporaryFilesOfKilledPrograms) {
  store_.start_stage(id_, {});
  const CheckpointRecord record = store_.record_checkpoint(id_, sample_checkpoint(id_));
  const pid_t child = fork();
  if (child == 0) _exit(0);
  waitpid(child, nullptr, 0);
  const auto name = [](const std::string& begin, pid_t pid) {
    return begin + ".tmp-" + std::to_string(pid) + "-0";
  };
  const fs::path objects = (path_ / record.file).parent_path();
  const std::vector<fs::path> left = {objects / name("", child),
                                      path_ / name(".store.sqlite", child)};
  const std::vector<fs::path> others = {objects / name("", getpid()),
                                        objects / name("", 0),
                                        objects / name("kept", child),
                                        objects / ".tmp-x-0",
                                        path_ / (".tmp-" + std::to_string(child)),
                                        path_ / ".tmp-"};
  for (const auto* files : {&left, &others}) {
    for (const fs::path& file : *files) write_bytes(file, "half");
  }
  const fs::path used = objects / (".tmp-" + std::to_string(child) + "-1");
  const Descriptor lock(::open(used.c_str(), O_CREAT | O_WRONLY, 0600));  // of another container
  flock(lock.get(), LOCK_EX);
  open(Access::read);
  for (const fs::path& file : left) EXPECT_TRUE(fs::exists(file)) << file;
  open(Access::write);
  for (const fs::path& file : left) EXPECT_FALSE(fs::exists(file)) << file;
  for (const fs::path& file : others) EXPECT_TRUE(fs::exists(file)) << file;
  EXPECT_TRUE(fs::exists(used));
}

TEST_F(StoreTest, IsReadOnlyIfItMayNotBeWritten) {
  if (geteuid() == 0) GTEST_SKIP() << "root writes everything";
  const auto expect_only_read = [&](const fs::path& path) {
    fs::permissions(path, fs::perms::owner_write, fs::perm_options::remove);
    expect_refused<MachineError>([&] { open(Access::write); }, {path.string(), "permissions"});
    EXPECT_EQ(open(Access::read).stages().size(), 1u);
    fs::permissions(path, fs::perms::owner_write, fs::perm_options::add);
  };
  expect_only_read(path_);
  expect_only_read(path_ / "store.sqlite");
  EXPECT_EQ(open(Access::write).stages().size(), 1u);
}

TEST_F(StoreTest, IsReadOnlyWithoutItsObjects) {
  store_.start_stage(id_, {});
  store_.record_checkpoint(id_, sample_checkpoint(id_));
  const Head head = store_.head();
  fs::remove_all(path_ / "objects");
  for (const bool empty : {false, true}) {
    for (const Access access : {Access::write, Access::create}) {
      expect_refused<StoreDamaged>([&] { open(access); }, {"objects", "missing or empty"});
    }
    EXPECT_EQ(open(Access::read).head().hash, head.hash);
    if (!empty) fs::create_directory(path_ / "objects");  // as where nothing is mounted
  }
}

}  // namespace
}  // namespace shearcell
