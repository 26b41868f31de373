// SPDX-License-Identifier: GPL-3.0-or-later
// `new`, the manual, `doctor`, and tables that fit a terminal and have colours
// only there.
#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "experiments/manifest/manifest.hpp"
#include "experiments/manifest/schema.hpp"
#include "experiments/manifest/suggest.hpp"
#include "experiments/runner/terminal.hpp"
#include "provenance/io/child_process.hpp"
#include "tests/experiments/program.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;

class Convenience : public ProgramTest {
 protected:
  /// Output of a script of sh that must succeed.
  std::string shell_output(const std::string& script) {
    const Outcome outcome = shell(script);
    EXPECT_EQ(outcome.code, 0) << script << "\n" << outcome.out << outcome.err;
    return outcome.out;
  }

  /// Its output on a terminal of that width.
  std::string on_terminal(int columns, const std::string& environment, const std::string& words) {
    return shell_output("script -qec 'stty cols " + std::to_string(columns) + "; TERM=xterm " +
                        environment + " " + SHEARCELL_PROGRAM + " " + words + "' /dev/null");
  }
};

TEST_F(Convenience, PlanAndRunSayWhatIsReadOfAFileOfGrains) {
  write("grains.csv", "x_d,y_d,z_d,element\n1,1,1,C\n3,1,1,\"C, N\"\n");
  write("m.yaml", renamed(tiny_manifest("  walls: smooth\n  grains: 2\n  cycles: 0\n"
                                        "  nominal_packing_fraction: 0.03\n"
                                        "  fill_packing_fraction: 0.02\n  height_over_width: 1\n",
                                        "start: {file: grains.csv}\n"),
                          "placed"));
  const std::string says = "grains.csv: 2 grains, no box, no velocities; not read: element";
  EXPECT_TRUE(has(expect(0, {"plan", "m.yaml"}).out, says));
  EXPECT_TRUE(has(json({"plan", "m.yaml", "--json"}).at("notes").dump(), says));
  EXPECT_TRUE(has(expect(0, {"run", "m.yaml", "-q"}).out, says));
  write("grains.csv", "x,y,z,v_x\n1,1,1,0\n3,1,1,0\n");
  expect_refused({"run", "m.yaml"},
                 {"grains.csv:1:7: is not a valid name for a position or velocity (got v_x)"});
}

TEST_F(Convenience, NewWritesAManifestThatExpandsAndNamesEveryKey) {
  expect(0, {"new", "softer"});
  const std::string text = read_bytes(path("softer.yaml"));
  const Manifest manifest = parse_manifest(text, "softer.yaml");
  EXPECT_EQ(manifest.experiment, "softer");
  for (const std::string_view key : names_of(schema())) {
    EXPECT_TRUE(has(text, std::string(key) + ":"));
  }

  // Without the marks of a comment it says the same, so the defaults in it are the defaults.
  std::string stated = text;
  for (std::size_t at; (at = stated.find("  # ")) != std::string::npos;) {
    const std::size_t end = stated.find('\n', at);
    const std::string line = stated.substr(at + 4, end - at - 4);
    const std::string key = line.substr(0, line.find(':'));
    const bool is_key = find_field(key) != nullptr && line.find(": ") != std::string::npos;
    stated.replace(at, end - at, is_key ? "  " + line : "");
  }
  write("stated.yaml", stated);
  const nlohmann::json a = json({"plan", "softer.yaml", "--scale", "smoke", "--json"});
  const nlohmann::json b = json({"plan", "stated.yaml", "--scale", "smoke", "--json"});
  EXPECT_EQ(a.at("runs"), 4);
  for (std::size_t i = 0; i < a.at("stages").size(); ++i) {
    EXPECT_EQ(a.at("stages")[i].at("id"), b.at("stages")[i].at("id")) << i;
  }
}

TEST_F(Convenience, NewOverwritesNothing) {
  write("mine.yaml", "mine");
  expect_refused({"new", "mine"}, {"mine.yaml: the file already exists"});
  EXPECT_EQ(read_bytes(path("mine.yaml")), "mine");
  for (const std::string name : {"no name", "folder/a.b", "-x.yaml", "folder/"}) {
    expect_refused({"new", "--", name},
                   {"is not a valid name of an experiment. A name has 1 to 64"});
  }
}

TEST_F(Convenience, NewPrintsACommandThatCanBePasted) {
  const std::string said = run({"new", "a folder/softer.yml"}).out;
  EXPECT_EQ(listing(), (std::set<std::string>{"a folder", "a folder/softer.yml"}));
  const std::string next = "Next: shearcell ";
  ASSERT_TRUE(has(said, next + "plan 'a folder/softer.yml' --scale smoke\n")) << said;
  shell_output("\"$0\" " + said.substr(said.find(next) + next.size()));
  expect(0, {"new", "plain"}, {"shearcell plan plain.yaml --scale"});
}

// The manual of a machine is that of all: experiments/REFERENCE.md is compared with it.
TEST_F(Convenience, TheManualDoesNotDependOnTheEnvironment) {
  for (const Arguments& page : {Arguments{"manual"}, Arguments{"manual", "--markdown"}}) {
    const std::string usual = expect(0, page).out;
    name_store("elsewhere");
    EXPECT_EQ(run(page).out, usual);
    name_store("");
  }
}

TEST_F(Convenience, TheManualHasEveryCommand) {
  const std::string page = run({"manual"}).out;
  for (const std::string& command : commands()) {
    EXPECT_TRUE(has(page, "### shearcell " + command + "\n"));
  }
}

TEST_F(Convenience, DoctorReportsTheMachine) {
  const nlohmann::json findings = json({"doctor", "--no-speed", "--json"}).at("findings");
  std::set<std::string> seen;
  for (const auto& finding : findings) {
    seen.insert(finding.at("what"));
    EXPECT_FALSE(finding.at("found").get<std::string>().empty()) << finding;
    EXPECT_TRUE((std::set<std::string>{"ok", "slow", "low", "missing"})
                    .contains(finding.at("state").get<std::string>()))
        << finding;
  }
  for (const char* what : {"cores", "vectors", "disk", "writing", "SQLite", "HDF5", "gnuplot"}) {
    EXPECT_TRUE(seen.contains(what)) << what;
  }
  EXPECT_TRUE(listing().empty()) << "it left something behind";
  const Outcome nowhere = expect(1, {"doctor", "--no-speed", "--store", "/proc/x"},
                                 {"the program cannot write to this folder"});
  EXPECT_FALSE(has(nowhere.out, "room for"));
  write("plain", "");
  expect(1, {"doctor", "--no-speed", "--store", "plain"}, {"plain is a file"});
}

TEST_F(Convenience, TablesHaveColoursOnlyOnATerminal) {
  campaign(tiny_manifest());
  const std::string piped = run({"status"}).out;
  EXPECT_FALSE(has(piped, "\x1b"));
  EXPECT_TRUE(has(piped, "completed"));
  EXPECT_TRUE(has(on_terminal(80, "", "status"), "\x1b[32mcompleted"));
  EXPECT_FALSE(has(on_terminal(80, "NO_COLOR=1", "status"), "\x1b"));
  // Long enough that progress is drawn.
  EXPECT_TRUE(has(on_terminal(80, "NO_COLOR=1", "run m.yaml --cycles 60"), "\x1b[2K"));
  std::size_t cycles = 60;
  for (const std::string environment : {"TERM=dumb", "env -u TERM"}) {
    const std::string longer = "run m.yaml --cycles " + std::to_string(cycles += 20);
    for (const std::string& words : {std::string("status"), longer}) {
      EXPECT_FALSE(has(on_terminal(80, environment, words), "\x1b")) << environment << " " << words;
    }
  }
}

TEST_F(Convenience, HelpFitsTheTerminal) {
  for (const std::string command : {"", "prune ", "export ", "figures "}) {
    const std::string whole = expect(0, split(command + "--help")).out;
    for (const int columns : {60, 85}) {
      std::string shown = on_terminal(columns, "", command + "--help");
      std::erase(shown, '\r');
      EXPECT_EQ(split(shown), split(whole)) << "the same words";
      std::istringstream lines(shown);
      for (std::string line; std::getline(lines, line);) {
        const bool one_word = line.find(' ', line.find_first_not_of(' ')) == line.npos;
        EXPECT_TRUE(one_word || columns_of(line) <= static_cast<std::size_t>(columns)) << line;
      }
    }
  }
}

TEST(Terminal, FilledTextKeepsColumns) {
  EXPECT_EQ(filled("One two three\nfour.\n\nExamples:\n  do it\n", 40),
            "One two three four.\n\nExamples:\n  do it\n");
  EXPECT_EQ(filled("  --name N      the quick brown fox jumps over the dog\n", 44),
            "  --name N      the quick brown fox jumps\n                over the dog\n");
}

TEST_F(Convenience, TablesAreCutBetweenCharacters) {
  std::string long_name;
  for (int k = 0; k < 20; ++k) long_name += "ϕ";
  campaign(tiny_manifest("", kBothFluids + "labels: {\"fluid=still\": " + long_name + "}\n"),
           {"--cycles", "1"});
  expect(0, {"status"}, {long_name + "  "});
  for (int columns = 56; columns < 66; ++columns) {  // fewer cannot hold its numbers
    const std::string shown = on_terminal(columns, "NO_COLOR=1", "status");
    const std::size_t at = shown.find("ϕ");
    ASSERT_NE(at, std::string::npos) << shown;
    std::size_t end = at;
    while (shown.compare(end, 2, "ϕ") == 0) end += 2;
    EXPECT_EQ(shown.substr(end, 3), "~  ") << columns << "\n" << shown;
    const std::size_t line = shown.rfind('\n', at) + 1;
    const std::size_t bytes = shown.find('\r', at) - line;
    EXPECT_LE(bytes - (end - at) / 2, static_cast<std::size_t>(columns)) << shown;
  }
}

TEST(Terminal, WideCharactersTakeTwoColumns) {
  EXPECT_EQ(columns_of("fluid"), 5U);
  EXPECT_EQ(columns_of("流体 ϕ"), 6U);
  EXPECT_EQ(columns_of("e\u0301"), 1U) << "an accent of its own";
  EXPECT_EQ(columns_of("\xff\xfe"), 2U) << "no UTF-8";
  EXPECT_EQ(first_columns("流体", 3), "流");
  EXPECT_EQ(first_columns("流体", 4), "流体");
  EXPECT_EQ(first_columns("", 4), "");
}

TEST_F(Convenience, LabelsOfWideCharactersKeepColumnsInLine) {
  campaign(
      tiny_manifest("", kBothFluids + "labels: {\"fluid=still\": 静止流体, \"fluid=cell\": a}\n"),
      {"--cycles", "1"});
  std::set<std::size_t> places;  // of the column after the label
  std::istringstream lines(expect(0, {"status"}).out);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t state = line.find("completed");
    const bool sum = line.find("stages: ") != line.npos;
    if (state != line.npos && !sum) places.insert(columns_of(line.substr(0, state)));
  }
  EXPECT_EQ(places.size(), 1U);
}

TEST_F(Convenience, ExportsTheRequestedCycles) {
  campaign(tiny_manifest());
  const std::string id = last_run();
  const auto files = [&](const std::string& format, const std::string& out,
                         const std::string& cycles) {
    return json({"export", id, "--to", format, "--out", out, "--cycles", cycles, "--json"})
        .at("files")
        .size();
  };
  EXPECT_EQ(files("h5md", "run.h5", "0"), 1U);
  EXPECT_EQ(files("extxyz", "run.xyz", "0:1"), 1U);
  EXPECT_EQ(files("vtk", "vtk", ":0"), 4U);  // grains, cell, the list of frames, and what they are
  EXPECT_EQ(files("lammps", "lammps", "0:1:1"), 5U);  // data and script of each, what they are

  expect_refused({"export", id, "--to", "extxyz", "--out", "other", "--cycles", "99"},
                 {"shearcell: run ", " has no stored checkpoint in cycles 99"});
  expect_refused({"export", id, "--to", "extxyz", "--out", "other", "--cycles", "20:0"},
                 {"--cycles 20:0: the first cycle is after the last"});
  for (const std::string line : {"ro-crate --cycles 0", "ro-crate --metres", "vtk --metres",
                                 "h5md --license https://x.org"}) {
    expect_refused(joined({"export", id, "--out", "other", "--to"}, split(line)),
                   {"has no effect with --to " + line.substr(0, line.find(' '))});
  }
}

TEST_F(Convenience, OutputGoesToStreams) {
  campaign(tiny_manifest());
  const std::string id = last_run();
  const Arguments xyz = {"export", id, "--to", "extxyz", "--out"};
  expect(0, joined(xyz, {"run.xyz"}));
  expect(0, {"report", "--drawings", "--out", "page.html"});
  const Outcome exported = expect(0, joined(xyz, {"-"}));
  EXPECT_EQ(exported.out, read_bytes(path("run.xyz")));
  EXPECT_TRUE(expect(0, {"report", "--drawings", "--out", "-"}).out.starts_with("<!doctype html>"));
  const std::set<std::string> before = listing();
  for (const Arguments& words :
       {Arguments{"table"}, {"report", "--drawings"}, {"export", id, "--to", "extxyz"}}) {
    EXPECT_EQ(expect(0, joined(words, {"--out", "/dev/null"})).out, "");
  }
  for (const char* script : {"\"$0\" table --out /dev/fd/3 3>&1 2>/dev/null | cat",
                             "\"$0\" table --out /dev/fd/2 2>&1 | cat"}) {
    EXPECT_EQ(shell(script).out, expect(0, {"table"}).out) << script;
  }
  for (const Arguments& words : {Arguments{"figures"}, {"export", id, "--to", "vtk"}}) {
    expect_refused(joined(words, {"--out", "-"}), {"a folder is needed; give a folder"});
  }
  EXPECT_EQ(listing(), before);
}

TEST_F(Convenience, LabelsSelectVariants) {
  campaign(
      tiny_manifest("  cycles: 0\n", kBothFluids + "labels: {\"fluid=still\": \"at rest\"}\n"));
  const auto runs = [&](const std::string& variant) {
    return json({"status", "--json", "--variant", variant}).at("runs").size();
  };
  EXPECT_EQ(runs("at rest"), 1U);
  EXPECT_EQ(runs("fluid=still"), 1U);
  EXPECT_EQ(json({"plan", "m.yaml", "--json", "--variant", "at rest"}).at("runs"), 1);
  expect_refused({"table", "--variant", "at rst"}, {"did you mean at rest?"});
  expect_refused({"plan", "m.yaml", "--variant", "at sea"}, {"fluid=still; at rest; fluid=cell"});
  expect_refused({"show", "tiny"}, {"tiny is an experiment", "status --experiment tiny"});
  expect_refused({"show", "tinny"}, {"the store has no run or figure 'tinny'; did you mean tiny?"});
}

TEST_F(Convenience, PlanNamesPackings) {
  write("m.yaml", tiny_manifest("", "sweep: {grid: {pressure_Pa: [300, 3000]}}\n"));
  for (const char* packing : {"packing P=300 Pa", "packing P=3000 Pa"}) {
    const std::string said = expect(0, {"plan", "m.yaml"}).out;
    EXPECT_NE(said.find(packing), said.rfind(packing)) << "in both tables\n" << said;
  }
  write("m.yaml", tiny_manifest("", kBothFluids));
  expect(0, {"plan", "m.yaml"}, {"  packing "});
}

TEST_F(Convenience, PlanSaysThatAManifestHasNoRunsOfItsOwn) {
  write("both.yaml", "experiment: both\nof: [tiny, other]\nplots: [{name: p, y: phi, x: cycle}]\n");
  EXPECT_EQ(expect(0, {"plan", "both.yaml"}).out,
            "both: 0 runs, 0 stages\n\n"
            "both has no runs of its own. Its figures use the runs of tiny, other.\n");
}

TEST_F(Convenience, RunSumsUpManyWarnings) {
  write("m.yaml", tiny_manifest("  cycles: 0\n",
                                "seeds: 1\nplots:\n"
                                "  - {name: a, y: phi, at_cycle: 9}\n"
                                "  - {name: b, y: phi, at_cycle: 9}\n"
                                "  - {name: c, y: phi, at_cycle: 9}\n"
                                "  - {name: d, y: phi, at_cycle: 9}\n"));
  const auto warnings = [](const Outcome& outcome) {
    std::istringstream lines(outcome.err);
    std::size_t count = 0;
    for (std::string line; std::getline(lines, line);) count += line.starts_with("warning: ");
    return count;
  };
  EXPECT_GT(warnings(expect(0, {"plan", "m.yaml"})), 3U);
  EXPECT_EQ(warnings(expect(0, {"run", "m.yaml", "-q"}, {"`shearcell plan` prints"})), 1U);
}

TEST_F(Convenience, StatusShowsWhatEachExperimentAsksFor) {
  campaign(tiny_manifest(), {"--cycles", "5"});
  write("early.yaml", renamed(tiny_manifest("", "until: {phi: 0.1, extra_cycles: 2}\n"), "early"));
  expect(0, {"run", "early.yaml", "--cycles", "9", "-q"});
  const std::string shown = expect(0, {"status"}).out;
  const std::string tiny = shown.substr(shown.find("tiny\n"));
  EXPECT_TRUE(has(shown, "2/9 (until)")) << shown;
  EXPECT_TRUE(has(tiny, " 5/5 ")) << shown;
}

// Its end would be decided by a measure that is lost.
TEST_F(Convenience, ExportOfARunWithAnUnknownEndEnds) {
  campaign(tiny_manifest(), {"--cycles", "5"});
  write("early.yaml", renamed(tiny_manifest("", "until: {phi: 0.99}\n"), "early"));
  expect(0, {"run", "early.yaml", "--cycles", "3", "-q"});
  expect(0, {"prune", "--last-too", "--yes"});
  fs::remove(path("shearcell-store/derived.sqlite"));
  expect(2, {"export", "--experiment", "early", "--to", "extxyz", "--out", "x"},
         {"`shearcell regenerate "});
}

class TimeSteps : public ProgramTest {};

TEST_F(TimeSteps, ArePrintedByPlanWithWarnings) {
  const std::string head = "experiment: a\nbase: {grains: 600, cycles: 1, ";
  const std::string sound = write("sound.yaml", head + "steps_per_cycle: 45600}\n");
  EXPECT_EQ(expect(0, {"plan", sound}, {"0.355", "overlap [d]"}).err, "");
  const nlohmann::json stage = json({"plan", sound, "--json"}).at("stages").at(1);
  EXPECT_NEAR(stage.at("time_step").at("over_contact_time"), 0.1129, 1e-4);
  EXPECT_NEAR(stage.at("expected_overlap_d"), 3.797e-3, 1e-5);
  const std::string small = write("small.yaml", head + "steps_per_cycle: 200000}\n");
  const std::string stiffened =
      write("stiffen.yaml", "experiment: a\nbase: {grains: 600, protocol: stiffen}\n");
  expect(0, {"plan", small}, {"below 0.15"});
  const nlohmann::json both = json({"plan", small, sound, "--json"});
  ASSERT_EQ(both.at("warnings").size(), 2U);
  EXPECT_TRUE(has(both.at("warnings")[0].get<std::string>(), "below 0.15"));
  EXPECT_EQ(both.at("experiments").size(), 2U);
  EXPECT_EQ(json({"plan", stiffened, "--json"}).at("stages").at(1).at("time_step"), nullptr);
}

}  // namespace
}  // namespace shearcell::test
