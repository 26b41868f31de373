// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/experiments/damage.hpp"

#include <sqlite3.h>
#include <sys/stat.h>

#include "analysis/measures.hpp"
#include "provenance/derived.hpp"
#include "provenance/errors.hpp"
#include "provenance/objects.hpp"
#include "tests/experiments/temporary_store.hpp"
#include "tests/support/frame.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {

namespace fs = std::filesystem;

namespace {

/// The log without the program's limits and checks.
class RawLog {
 public:
  explicit RawLog(const fs::path& store) {
    EXPECT_EQ(sqlite3_open((store / "store.sqlite").c_str(), &handle_), SQLITE_OK);
    run("DROP TRIGGER IF EXISTS events_are_never_updated");
    run("DROP TRIGGER IF EXISTS events_are_never_deleted");
  }
  ~RawLog() { sqlite3_close(handle_); }
  RawLog(const RawLog&) = delete;
  RawLog& operator=(const RawLog&) = delete;
  void run(const std::string& sql) {
    EXPECT_EQ(sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sql << ": " << sqlite3_errmsg(handle_);
  }

 private:
  sqlite3* handle_ = nullptr;
};

}  // namespace

Damage sql(const std::string& statements) {
  return [=](const fs::path& store) { RawLog(store).run(statements); };
}

Damage forged(const std::function<void(Event&)>& change) {
  return [=](const fs::path& store) {
    std::vector<Event> events = Store(store, Access::read).events();
    RawLog log(store);
    std::string prev(64, '0');
    for (Event& event : events) {
      change(event);
      event.prev_hash = prev;
      prev = event.hash = event_hash(event);
      log.run("UPDATE events SET stream = " + sql_text(event.stream) +
              ", type = " + sql_text(event.type) + ", schema = " + std::to_string(event.schema) +
              ", recorded_at = " + sql_text(event.recorded_at) +
              ", payload = " + sql_text(event.payload) + ", prev_hash = '" + event.prev_hash +
              "', hash = '" + event.hash + "' WHERE seq = " + std::to_string(event.seq));
    }
  };
}

Damage payload(const std::string& type, const std::function<void(nlohmann::json&)>& change) {
  return forged([=](Event& event) {
    if (event.type != type) return;
    nlohmann::json body = nlohmann::json::parse(event.payload);
    change(body);
    event.payload = body.dump();
  });
}

fs::path an_object(const fs::path& store) {
  std::set<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(store / "objects")) {
    if (entry.path().extension() == ".h5") files.insert(entry.path());
  }
  return *files.begin();
}

Damage object(const std::function<void(const fs::path& file)>& change) {
  return [=](const fs::path& store) { change(an_object(store)); };
}

Damage at(const std::string& name, const std::function<void(const fs::path&)>& change) {
  return [=](const fs::path& store) { change(store / name); };
}

std::function<void(const fs::path&)> written(const std::string& bytes) {
  return [=](const fs::path& file) { write_bytes(file, bytes); };
}

Damage unmeasured(const Damage& damage) {
  return [=](const fs::path& store) {
    damage(store);
    fs::remove(store / DerivedCache::kFile);
  };
}

void removed(const fs::path& path) {
  fs::remove_all(path);
}

void link_instead(const fs::path& path) {
  const fs::path elsewhere = fs::path(path.parent_path()) / "moved-away";
  fs::rename(path, elsewhere);
  fs::create_symlink(elsewhere, path);
}

void pipe_instead(const fs::path& path) {
  fs::remove_all(path);
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
}

void folder_instead(const fs::path& path) {
  fs::remove(path);
  fs::create_directory(path);
}

void forge_checkpoints(const fs::path& store, const std::string& hdf5) {
  ObjectStore objects(store);
  const std::vector<std::byte> image = sealed(std::as_bytes(std::span(hdf5)));
  const std::string sha256 = objects.put(image);
  payload("CheckpointRecorded", [&](nlohmann::json& body) {
    body["sha256"] = sha256;
    body["file"] = ObjectStore::file_of(sha256);
    body["size"] = image.size();
  })(store);
  Store(store, Access::write).rebuild();
}

Damage rebuilt(const Damage& damage) {
  return [=](const fs::path& store) {
    damage(store);
    try {
      Store(store, Access::write).rebuild();
    } catch (const StoreDamaged&) {
      // The command under test meets it as well.
    }
  };
}

Damage states(const std::function<void(Checkpoint&)>& change) {
  return rebuilt([=](const fs::path& store) {
    struct Made {
      Checkpoint checkpoint;
      std::string sha256;
      std::size_t size;
    };
    std::map<std::string, Made> made;  // by the former SHA-256
    {
      const Store known(store, Access::read);
      ObjectStore objects(store);
      for (const Stage& run : known.stages()) {
        for (const CheckpointRecord& record : known.checkpoints(run.id)) {
          Checkpoint checkpoint = known.load_checkpoint(record);
          change(checkpoint);
          const auto bytes = encode_checkpoint(checkpoint);
          made[record.sha256] = {std::move(checkpoint), objects.put(bytes), bytes.size()};
        }
      }
    }
    payload("CheckpointRecorded", [&](nlohmann::json& body) {
      const auto& [checkpoint, sha256, size] = made.at(body["sha256"]);
      body["step"] = checkpoint.state.step;
      body["cycle"] = checkpoint.cycle;
      body["time_s"] = checkpoint.time_s;
      body["observables"] = checkpoint.observables;
      body["state_hash"] = state_hash(checkpoint);
      body["file"] = ObjectStore::file_of(sha256);
      body["size"] = size;
    })(store);
    forged([&](Event& event) {
      for (const auto& [before, now] : made) {
        for (std::size_t at = 0; (at = event.payload.find(before, at)) != std::string::npos;) {
          event.payload.replace(at, before.size(), now.sha256);
          at += before.size();
        }
      }
    })(store);
  });
}

Damage measures(const std::string& name, const std::function<void(nlohmann::json&)>& change) {
  return [=](const fs::path& store) {
    std::vector<DerivedKey> keys;
    {
      const sqlite::Database kept(store / DerivedCache::kFile, Access::write);
      sqlite::Statement row(kept, "SELECT checkpoint, measure, version FROM derived");
      while (row.step()) {
        DerivedKey& key = keys.emplace_back();
        row.get(key.checkpoint, key.measure, key.version);
      }
    }
    DerivedCache cache(store);
    std::vector<DerivedObject> changed;
    for (const DerivedKey& key : keys) {
      if (!key.measure.starts_with(name)) continue;
      nlohmann::json content = decode_result(cache.get(std::span(&key, 1)).front().value());
      change(content);
      changed.push_back({key, encode_result(content)});
    }
    ASSERT_FALSE(changed.empty());
    cache.put(changed);
  };
}

}  // namespace shearcell::test
