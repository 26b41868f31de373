// SPDX-License-Identifier: GPL-3.0-or-later
// What makes the program pleasant: a manifest to begin with, completion, the manual page, the
// doctor, and tables that fit a terminal and have colours there alone.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <sstream>

#include "experiments/manifest/manifest.hpp"
#include "experiments/manifest/schema.hpp"
#include "experiments/manifest/suggest.hpp"
#include "tests/experiments/program.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;

std::string shell_output(const std::string& command) {
  std::string out;
  std::FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return out;
  std::array<char, 4096> bytes;
  for (std::size_t n; (n = fread(bytes.data(), 1, bytes.size(), pipe)) > 0;) {
    out.append(bytes.data(), n);
  }
  EXPECT_EQ(pclose(pipe), 0) << command << "\n" << out;
  return out;
}

bool has_program(const std::string& name) {
  return std::system(("command -v " + name + " >/dev/null 2>&1").c_str()) == 0;
}

class Comfort : public ProgramTest {
 protected:
  std::string text_of(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(path(name)).rdbuf();
    return text.str();
  }

  /// What bash offers after these words, the last of which is being typed.
  std::string completed(const std::string& shell_name, const std::vector<std::string>& words) {
    std::string typed;
    for (const std::string& word : words) typed += " '" + word + "'";
    write("try",
          (shell_name == "zsh" ? "autoload -U +X compinit && compinit -u -D\nsetopt ksharrays\n"
                               : "") +
              std::string("source ./script\nCOMP_WORDS=(") + typed + ")\nCOMP_CWORD=" +
              std::to_string(words.size() - 1) + "\n_shearcell\necho \"${COMPREPLY[@]}\"\n");
    return shell_output("cd " + path("").string() + " && " + shell_name + " ./try");
  }

  /// Its output on a terminal of that width.
  std::string on_terminal(int columns, const std::string& environment, const std::string& words) {
    return shell_output("cd " + path("").string() + " && script -qec 'stty cols " +
                        std::to_string(columns) + "; TERM=xterm " + environment +
                        " " SHEARCELL_PROGRAM " " + words + "' /dev/null");
  }
};

TEST_F(Comfort, NewWritesAManifestThatExpandsAndNamesEveryKey) {
  ASSERT_EQ(run({"new", "softer"}).code, 0);
  const std::string text = text_of("softer.yaml");
  const Manifest manifest = parse_manifest(text, "softer.yaml");
  EXPECT_EQ(manifest.experiment, "softer");
  for (const std::string_view key : names_of(schema())) {
    EXPECT_NE(text.find(std::string(key) + ":"), std::string::npos) << key;
  }
  EXPECT_EQ(json({"plan", "softer.yaml", "--scale", "smoke", "--json"}).at("runs"), 4);

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
  for (std::size_t i = 0; i < a.at("stages").size(); ++i) {
    EXPECT_EQ(a.at("stages")[i].at("id"), b.at("stages")[i].at("id")) << i;
  }
}

TEST_F(Comfort, NewLeavesWhatIsThereAlone) {
  write("mine.yaml", "mine");
  const Outcome again = run({"new", "mine"});
  EXPECT_EQ(again.code, 2);
  EXPECT_NE(again.err.find("mine.yaml: the file exists already"), std::string::npos) << again.err;
  EXPECT_EQ(text_of("mine.yaml"), "mine");
  EXPECT_EQ(run({"new", "no name"}).code, 2);
  EXPECT_FALSE(fs::exists(path("no name.yaml")));
}

TEST_F(Comfort, ShellsCompleteCommandsAndOptions) {
  write("script", run({"completion", "bash"}).out);
  EXPECT_EQ(completed("bash", {"shearcell", "ru"}), "run\n");
  EXPECT_EQ(completed("bash", {"shearcell", "bench", "sp"}), "speed\n");
  EXPECT_EQ(completed("bash", {"shearcell", "run", "x.yaml", "--sc"}), "--scale\n");
  EXPECT_EQ(completed("bash", {"shearcell", "verify", "--rep"}), "--replay\n");
  if (has_program("zsh")) {  // which chooses among the words itself
    write("script", run({"completion", "zsh"}).out);
    EXPECT_NE(completed("zsh", {"shearcell", "ru"}).find(" run "), std::string::npos);
    EXPECT_NE(completed("zsh", {"shearcell", "bench", "sp"}).find("speed"), std::string::npos);
    EXPECT_NE(completed("zsh", {"shearcell", "run", "--sc"}).find(" --scale "), std::string::npos);
  }
  write("script", run({"completion", "fish"}).out);
  if (has_program("fish")) {
    const std::string in_folder = "cd " + path("").string() + " && fish -c 'source script; ";
    EXPECT_EQ(shell_output(in_folder + "complete -C \"shearcell bench sp\"'").substr(0, 6),
              "speed\t");
    EXPECT_EQ(shell_output(in_folder + "complete -C \"shearcell run --sc\"'").substr(0, 8),
              "--scale\t");
  }
  EXPECT_EQ(run({"completion", "tcsh"}).code, 2);
}

TEST_F(Comfort, TheManualHasEveryCommand) {
  const std::string page = run({"manual"}).out;
  const std::string help = run({"--help"}).out;
  std::istringstream lines(help.substr(help.find("Subcommands:")));
  std::size_t commands = 0;
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line) && line.starts_with("  ")) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (line[2] == ' ') continue;  // the rest of a meaning
    EXPECT_NE(page.find(".SS shearcell " + word + "\n"), std::string::npos) << word;
    ++commands;
  }
  EXPECT_GE(commands, 16U);
  if (has_program("groff")) {
    write("page", page);
    EXPECT_EQ(shell_output("groff -man -Tutf8 -ww -z " + path("page").string() + " 2>&1"), "");
  }
}

TEST_F(Comfort, TheDoctorSaysWhatThereIs) {
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
}

TEST_F(Comfort, TablesFitTheTerminalAndHaveColoursThereAlone) {
  campaign(tiny_manifest());
  const std::string piped = run({"status"}).out;
  EXPECT_EQ(piped.find('\x1b'), std::string::npos);
  EXPECT_NE(piped.find("completed"), std::string::npos);

  EXPECT_NE(on_terminal(80, "", "status").find("\x1b[32mcompleted"), std::string::npos);
  const std::string plain = on_terminal(44, "NO_COLOR=1", "status");
  EXPECT_EQ(plain.find('\x1b'), std::string::npos) << plain;
  std::istringstream lines(plain);
  for (std::string line; std::getline(lines, line);) {
    if (line.find("completed") != std::string::npos && line.find("stages") == std::string::npos) {
      EXPECT_LE(line.size(), 45U) << line;  // and the terminal's carriage return
    }
  }
  EXPECT_EQ(on_terminal(80, "TERM=dumb", "status").find('\x1b'), std::string::npos);
}

TEST_F(Comfort, TablesAreCutBetweenCharacters) {
  std::string long_name;
  for (int k = 0; k < 20; ++k) long_name += "ϕ";
  campaign(tiny_manifest("", kBothFluids + "labels: {\"fluid=still\": " + long_name + "}\n"),
           {"--cycles", "1"});
  EXPECT_NE(run({"status"}).out.find(long_name + "  "), std::string::npos);
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

TEST_F(Comfort, ExportsTheCyclesThatAreAskedFor) {
  campaign(tiny_manifest());
  std::string id;
  const nlohmann::json runs = json({"status", "--json"}).at("runs");
  for (const nlohmann::json& one : runs) {
    if (one.at("kind") == "shear") id = one.at("id");
  }
  const auto files = [&](const std::string& format, const std::string& out,
                         const std::string& cycles) {
    return json({"export", id, "--to", format, "--out", out, "--cycles", cycles, "--json"})
        .at("files")
        .size();
  };
  EXPECT_EQ(files("h5md", "run.h5", "0"), 1U);
  EXPECT_EQ(files("extxyz", "run.xyz", "0:1"), 1U);
  EXPECT_EQ(files("vtk", "vtk", ":0"), 4U);  // grains, cell, the list of frames, and what they are
  EXPECT_EQ(files("lammps", "lammps", "0:1:1"), 3U);

  const auto before = listing();
  for (const Arguments& words :
       {Arguments{"--out", "run.xyz"}, Arguments{"--out", "other", "--cycles", "one"},
        Arguments{"--out", "other", "--cycles", "99"},
        Arguments{"--out", "other", "--cycles", "1:2:3:4"}}) {
    Arguments all{"export", id, "--to", "extxyz"};
    all.insert(all.end(), words.begin(), words.end());
    const Outcome outcome = run(all);
    EXPECT_EQ(outcome.code, 2) << words.back();
    EXPECT_FALSE(outcome.err.empty());
  }
  EXPECT_EQ(listing(), before);
}

TEST_F(Comfort, WatchingEndsWhenNobodyIsAtWork) {
  campaign(tiny_manifest());
  const Outcome watched = run({"status", "--watch", "0.1"});
  EXPECT_EQ(watched.code, 0);
  EXPECT_EQ(watched.out, run({"status"}).out);
}

}  // namespace
}  // namespace shearcell::test
