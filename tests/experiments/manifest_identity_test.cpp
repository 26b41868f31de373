// SPDX-License-Identifier: GPL-3.0-or-later
// A run's key depends on every value that decides its bits, and on nothing else.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "experiments/manifest/expand.hpp"
#include "experiments/manifest/identity.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

using nlohmann::json;

// The parameters of the runs of the oldest stores, whose keys are pinned.
Parameters oldest() {
  return {.pressure_at = PressureAt::moving_wall};
}

void expect_refused_with(json record, const char* key, std::initializer_list<json> values) {
  for (const json& value : values) {
    record["parameters"][key] = value;
    EXPECT_THROW(read_stage(record), std::runtime_error) << key << " = " << value;
  }
}

TEST(Identity, DependsOnSeedAndParent) {
  EXPECT_NE(prepare_stage({}, 1).id, prepare_stage({}, 2).id);
  Stage parent = prepare_stage({}, 1);
  const std::string key = last_stage({}, 1, parent).id;
  EXPECT_NE(last_stage({}, 2, parent).id, key);
  parent.id[0] = parent.id[0] == '0' ? '1' : '0';
  EXPECT_NE(last_stage({}, 1, parent).id, key);
}

TEST(Identity, DamagedRecordsAreRejectedByName) {
  const Stage prepare = prepare_stage(oldest(), 1);
  const json good = last_stage(oldest(), 1, prepare).resolved;
  const auto message = [](const json& record) {
    return message_of<std::runtime_error>([&] { read_stage(record); });
  };
  EXPECT_EQ(message(good), "");
  EXPECT_NE(message(json::array()), "");
  for (const auto& [key, value] : good.items()) {
    json record = good;
    record.erase(key);
    EXPECT_TRUE(has(message(record), key));
    record[key] = nullptr;
    EXPECT_NE(message(record), "") << key;
  }
  for (const auto& [key, value] : good["parameters"].items()) {
    json record = good;
    record["parameters"].erase(key);
    EXPECT_TRUE(has(message(record), key));
    for (const json& bad : {json(-1), json("nonsense"), json(), json(1e300), json::array()}) {
      record["parameters"][key] = bad;
      EXPECT_TRUE(has(message(record), key)) << key << " = " << bad;
    }
  }
  for (const char* key : {"stage", "parent", "extra"}) {
    json record = good;
    record[key] = "nonsense";
    EXPECT_TRUE(has(message(record), key));
  }
  json record = good;
  record["parameters"]["cycles"] = 3;
  EXPECT_TRUE(has(message(record), "cycles"));
}

// Pinned, so that no change of code renames the runs of existing stores unnoticed.
TEST(Identity, KeysNeverChange) {
  const Parameters parameters = oldest();
  const Stage prepare = prepare_stage(parameters, 1);
  EXPECT_EQ(prepare.id, "11372fd7ee85ce5f268a00dfc54425ee42a83b439525ed42a3226df21f52c84a");
  EXPECT_EQ(last_stage(parameters, 1, prepare).id,
            "af0e1ba04e22e5c47270333c327e914b406392687715750da472a7d802d3dfc5");
  EXPECT_EQ(prepare_stage({}, 1).id,
            "68b21760ec6eaef04455c4ce553a7ee5b8ac493875c81e7f3d2911321268899f");
}

TEST(Identity, OfAStiffeningHasOnlyTheParametersThatActOnIt) {
  Parameters parameters = oldest();
  parameters.protocol = ProtocolKind::stiffen;
  const Stage prepare = prepare_stage(parameters, 1);
  EXPECT_EQ(prepare.id, prepare_stage(oldest(), 1).id) << "it starts from the packing of a shear";
  const Stage stiffen = last_stage(parameters, 1, prepare);
  EXPECT_EQ(stiffen.kind, name_of(StageKind::stiffen));
  EXPECT_EQ(stiffen.id, "6e510f667806a5df08b990f7e0450abc4f7d1e616d178fc5444b0fd1984f4dd5");
  EXPECT_EQ(last_stage({}, 1, prepare).kind, name_of(StageKind::shear));

  const StageInputs record = read_stage(json::parse(stiffen.resolved.dump()));
  EXPECT_EQ(record.stage, StageKind::stiffen);
  EXPECT_EQ(record.parent, prepare.id);
  EXPECT_EQ(record.parameters, parameters);

  EXPECT_TRUE(stiffen.resolved.at("parameters").contains("minimize_force_tolerance"));
  for (const char* ineffective : {"amplitude_rad", "protocol", "engine", "pause_s", "fluid"}) {
    EXPECT_FALSE(stiffen.resolved.at("parameters").contains(ineffective)) << ineffective;
  }
  // This program never records a shear with the protocol stiffen.
  expect_refused_with(last_stage({}, 1, prepare).resolved, "protocol", {"stiffen"});
}

TEST(Identity, HasAPauseOnlyIfTheProtocolIsPaused) {
  Parameters longer{.pressure_at = PressureAt::moving_wall, .pause_s = 3};
  const Stage prepare = prepare_stage(oldest(), 1);
  EXPECT_EQ(prepare_stage(longer, 1).id, prepare.id);
  const Stage continuous = last_stage(longer, 1, prepare);
  EXPECT_EQ(continuous.id, last_stage(oldest(), 1, prepare).id);
  EXPECT_FALSE(continuous.resolved.at("parameters").contains("pause_s"));

  Parameters paused = oldest();
  paused.protocol = longer.protocol = ProtocolKind::paused;
  EXPECT_EQ(prepare_stage(paused, 1).id, prepare.id);
  const Stage shear = last_stage(paused, 1, prepare);
  // The runs of older stores, whose moving wall is free during a pause.
  Parameters free = paused;
  free.pause_walls = PauseWalls::moving;
  const Stage older = last_stage(free, 1, prepare);
  EXPECT_EQ(older.id, "e6e8e2b64efd95186ef23bc827b867e5441eefd1ef729840f8675abf5937903b");
  EXPECT_FALSE(older.resolved.at("parameters").contains("pause_walls"));
  EXPECT_EQ(read_stage(older.resolved).parameters, free);
  EXPECT_NE(older.id, shear.id);
  EXPECT_NE(last_stage(longer, 1, prepare).id, shear.id);
  EXPECT_EQ(read_stage(last_stage(longer, 1, prepare).resolved).parameters, longer);

  // Neither kind of record reads as the other.
  expect_refused_with(shear.resolved, "protocol", {"continuous"});
  expect_refused_with(continuous.resolved, "protocol", {"paused"});
}

// A parameter younger than the stores: runs that do not use it keep the keys that they have.
TEST(Identity, HasADrawOfWallGrainsOnlyIfNotTheFirst) {
  const Stage first = prepare_stage({}, 1);
  EXPECT_FALSE(first.resolved.at("parameters").contains("wall_grain_draw"));
  const Parameters redrawn{.wall_grain_draw = 2};
  const Stage other = prepare_stage(redrawn, 1);
  EXPECT_NE(other.id, first.id);
  EXPECT_EQ(read_stage(other.resolved).parameters, redrawn);
  EXPECT_EQ(read_stage(last_stage(redrawn, 1, other).resolved).parameters, redrawn);
  EXPECT_EQ(read_stage(first.resolved).parameters, Parameters{});

  // The first draw, written out, would be a second name for one computation.
  expect_refused_with(other.resolved, "wall_grain_draw", {0, -1, "one", nullptr, 1e300});
}

// Part of the identity of older runs. Their records keep the value that they have.
TEST(Identity, HasTheFormerDefaultOfTheOverlapLimit) {
  json record = prepare_stage({.max_overlap_diameters = 0.4}, 1).resolved;
  EXPECT_EQ(record, prepare_stage({}, 1).resolved);
  EXPECT_EQ(record["parameters"]["max_overlap_diameters"], 0.1);
  EXPECT_EQ(read_stage(record).parameters, Parameters{});
  record["parameters"]["max_overlap_diameters"] = 0.02;
  EXPECT_EQ(read_stage(record).parameters.max_overlap_diameters, 0.02);
}

// Younger than the stores as well, and effective only where a moving bottom wall lifts grains.
TEST(Identity, HasWhereThePressureActsOnlyIfItMatters) {
  const Parameters at_top;
  const Stage stage = prepare_stage(at_top, 1);
  EXPECT_NE(stage.id, prepare_stage(oldest(), 1).id);
  EXPECT_EQ(read_stage(stage.resolved).parameters, at_top);
  for (const auto change : {+[](Parameters& p) { p.moving_wall = MovingWall::top; },
                            +[](Parameters& p) { p.gravity_m_per_s2 = 0; }}) {
    Parameters ineffective = at_top, other = oldest();
    change(ineffective);
    change(other);
    EXPECT_EQ(prepare_stage(ineffective, 1).id, prepare_stage(other, 1).id);
    expect_refused_with(prepare_stage(other, 1).resolved, "pressure_at", {"top"});
  }
}

TEST(Identity, HasAnEngineOnlyInTheShearAndIfNotOurs) {
  const Stage packing = prepare_stage({}, 1);
  const Stage ours = last_stage({}, 1, packing);
  EXPECT_FALSE(ours.resolved.at("parameters").contains("engine"));
  const Parameters other{.engine = EngineKind::lammps};
  EXPECT_EQ(prepare_stage(other, 1).id, packing.id);
  const Stage theirs = last_stage(other, 1, packing);
  EXPECT_NE(theirs.id, ours.id);
  EXPECT_EQ(read_stage(theirs.resolved).parameters.engine, EngineKind::lammps);
  EXPECT_EQ(engine_of(theirs.resolved), EngineKind::lammps);
  EXPECT_EQ(engine_of(ours.resolved), EngineKind::shearcell);
  expect_refused_with(theirs.resolved, "engine", {"shearcell", "gromacs", 1});
}

TEST(CanonicalJson, WritesEqualTextForEqualValues) {
  const json value = {{"b", {1, 2.5, true, nullptr}}, {"a", {{"y", "x\"\n"}, {"é", -0.0}}},
                      {"c", json::array()},           {"d", json::object()},
                      {"e", 4.385964912280702e-5},    {"f", 2.0}};
  EXPECT_EQ(canonical_json(value),
            R"({"a":{"y":"x\"\n","é":0},"b":[1,2.5,true,null],"c":[],"d":{},)"
            R"("e":4.385964912280702e-05,"f":2})");
}

TEST(CanonicalJson, RejectsNotANumber) {
  EXPECT_THROW(canonical_json(std::nan("")), std::invalid_argument);
  EXPECT_THROW(canonical_json({1, std::numeric_limits<double>::infinity()}), std::invalid_argument);
}

}  // namespace
}  // namespace shearcell::test
