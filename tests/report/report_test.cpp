// SPDX-License-Identifier: GPL-3.0-or-later
// The report is a function of the store, and no text of a store becomes markup.
#include "experiments/report/page.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <set>

#include "analysis/measures.hpp"
#include "experiments/figures/draw.hpp"
#include "experiments/figures/run_table.hpp"
#include "experiments/report/html.hpp"
#include "provenance/derived.hpp"
#include "provenance/errors.hpp"
#include "tests/experiments/temporary_store.hpp"
#include "tests/support/files.hpp"
#include "tests/support/text.hpp"
#include "tests/support/variable.hpp"

namespace shearcell::test {
namespace {

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++found;
  }
  return found;
}

/// The JSON that the front end reads.
nlohmann::json data_of(const std::string& html) {
  const std::string begin = "id=\"report-data\">";
  const std::size_t at = html.find(begin);
  if (at == std::string::npos) return nullptr;
  const std::size_t from = at + begin.size();
  return nlohmann::json::parse(html.substr(from, html.find("</script>", from) - from));
}

class ReportOf : public StoreTest {
 protected:
  Report report(const ReportOptions& options = {}) { return make_report(store_, options); }
  std::string make(const ReportOptions& options = {}) { return report(options).html; }

  static ReportOptions drawings() {
    ReportOptions options;
    options.interactive = false;
    return options;
  }
};

class ReportOfRuns : public ReportOf {
 protected:
  ReportOfRuns() { compute(store_, tiny_manifest("", kBothFluids)); }
};

TEST_F(ReportOfRuns, HasTheSameBytesTwiceAndAddsNoEvent) {
  const Head before = store_.head();
  const std::string first = make();
  std::filesystem::remove(store_.folder() / "derived.sqlite");
  ReportOptions options;
  options.workers = 3;
  EXPECT_EQ(make(options), first);
  EXPECT_EQ(make(drawings()), make(drawings()));
  EXPECT_EQ(store_.head().hash, before.hash);
}

TEST_F(ReportOfRuns, HoldsTheSelectedRuns) {
  ReportOptions options;
  options.runs.variants = {"fluid=cell"};
  const std::string html = make(options);
  EXPECT_EQ(count(html, "<tbody data-row="), 1U);
  EXPECT_TRUE(has(html, "<dt>inputs</dt><dd>1 run, ")) << "of the first figure";
  EXPECT_FALSE(has(html, "<dt>inputs</dt><dd>2 runs, "));
  options.runs.experiments = {"tini"};
  EXPECT_THROW(make(options), NotFound);
}

TEST_F(ReportOfRuns, HoldsQuestionVerdictRunsLineageAndNumbers) {
  const Report made = report();
  EXPECT_EQ(made.experiments, 1U);
  EXPECT_EQ(made.figures, 2U) << "S2, and Table I of all experiments";
  const Head head = store_.head();
  const std::string& html = made.html;
  for (const std::string& part :
       {std::string("Does the runner keep its promises?"), std::string("undecided"),
        std::string("fluid=still"), std::string("variant,cycle,phi_mean"), head.hash,
        runs_of_kind(store_, "shear").front().id,
        store_.checkpoints(runs_of_kind(store_, "shear").front().id).back().sha256}) {
    EXPECT_TRUE(has(html, part));
  }
}

TEST_F(ReportOfRuns, HasTheCaptionOfEachFigure) {
  const ComputedFigure drawn =
      compute_figure(store_, wanted_figures(store_, {"S2"}).figures.at(0), {});
  EXPECT_TRUE(has(drawn.caption, "Figure S2. ")) << drawn.caption;
  EXPECT_TRUE(has(drawn.caption, "Experiment tiny.")) << drawn.caption;
  for (const std::string& html : {make(), make(drawings())}) {
    EXPECT_TRUE(has(html, "<p class=\"caption\">" + escape_html(drawn.caption) + "</p>"));
    EXPECT_EQ(count(html, "<figcaption>(a) S2a"), 1U) << "the caption names panels by letters";
  }
}

TEST_F(ReportOf, SaysWhyAFigureOrAPlotIsEmpty) {
  compute(store_,
          tiny_manifest("",
                        "plots: [{name: late, y: phi, x: cycle, cycles: [7, 9], show: traces},\n"
                        "        {name: zero, y: crystalline_percent, x: cycle, log: y}]\n"));
  const std::string html = make();
  EXPECT_EQ(count(html, "Nothing is drawn: no run has a checkpoint at the cycles to be shown."),
            1U);
  const std::string why = "Nothing is drawn in zero: no run has the values to be shown.";
  EXPECT_TRUE(has(html, why));
  if (!has_front_end()) return;
  EXPECT_EQ(data_of(html)["charts"]["tiny.zero"]["empty"], why);
}

TEST_F(ReportOfRuns, SaysWhosePlotsDrawAListedFigure) {
  EXPECT_EQ(count(make(), "the manifest lists S2 only</dd>"), 1U);
}

// `figures` ends with code 2 for these, so the report must not end with 0.
TEST_F(ReportOfRuns, ReportsFiguresThatCannotBeMade) {
  EXPECT_TRUE(report().problems.empty());
  compute(store_,
          "experiment: averaged\nquestion: q\nfigures: [S7]\nbase:\n  grains: 300\n"
          "  period_s: 1\n  steps_per_cycle: 10000\n  settle_time_step_s: 1.0e-4\n"
          "  cycles: 2\n" +
              kBothFluids);
  const Report made = report();
  ASSERT_EQ(made.problems.size(), 1U);
  EXPECT_TRUE(made.problems.begin()->starts_with("figure averaged/S7: ")) << *made.problems.begin();
  EXPECT_THROW(compute_figure(store_, wanted_figures(store_, {"S7"}).figures.at(0), {}),
               UsageError);
}

// Neither `figures` nor the report fails for a figure whose experiment has no selected run.
TEST_F(ReportOf, IsCompleteWithoutFiguresThatHaveNoRunYet) {
  compute(store_, tiny_manifest("", "scales: {short: {}, long: {cycles: 3}}\n"),
          {.scale = "short"});
  compute(store_, renamed(tiny_manifest("", "scales: {short: {}, long: {cycles: 3}}\n"), "other"),
          {.scale = "long"});
  ReportOptions options;
  options.runs.scales = {"long"};
  const Report made = report(options);
  EXPECT_TRUE(made.problems.empty()) << *made.problems.begin();
  EXPECT_TRUE(made.notes.contains("left out: experiments without a selected run: tiny"));
}

TEST_F(ReportOfRuns, GivesTheFrontEndPlotsPackingsAndTraces) {
  if (!has_front_end()) GTEST_SKIP() << "built without Node: there is no front end";
  const nlohmann::json data = data_of(make());
  ASSERT_TRUE(data.is_object());
  EXPECT_TRUE(data.at("charts").contains("tiny.S2b"));
  const auto& series = data.at("charts").at("tiny.S2a").at("series");
  ASSERT_EQ(series.size(), 2U);
  EXPECT_EQ(series[0].at("points").size(), 3U) << "cycles 0, 1 and 2";
  EXPECT_EQ(series[0].at("of"), "fluid=still") << "by which the page gives a variant one colour";
  ASSERT_EQ(data.at("packings").size(), 2U);
  const auto& run = data.at("packings")[0];
  const auto grains = run.at("grains").get<std::size_t>();
  const auto walls = run.at("wall_grains").get<std::size_t>();
  const auto bytes = run.at("frames")[0].at("data").get<std::string>();
  EXPECT_EQ(bytes.size(), (6 * (grains + walls) + 13 * grains + 2) / 3 * 4);
  const auto& frame = run.at("frames")[0];
  EXPECT_EQ(frame.at("fields").size(), 10U);
  EXPECT_TRUE(has(frame.at("facts").dump(), "% of the interior grains crystalline"));
  EXPECT_TRUE(frame.at("crystalline").is_number());
  EXPECT_EQ(frame.at("profiles").at("phi").size(), frame.at("profiles").at("height").size());
  ASSERT_EQ(data.at("experiments").size(), 1U);
  std::set<std::string> variants;
  for (const auto& trace : data.at("experiments")[0].at("runs")) {
    EXPECT_EQ(trace.at("cycle"), (nlohmann::json{0.0, 1.0, 2.0}));
    EXPECT_EQ(trace.at("crystalline_percent").size(), 3U);
    EXPECT_NEAR(trace.at("phi")[0].get<double>(), 0.6, 0.1);
    variants.insert(trace.at("variant"));
  }
  EXPECT_EQ(variants, (std::set<std::string>{"fluid=cell", "fluid=still"}));
}

TEST_F(ReportOfRuns, ShowsPackingsOfTheNewestManifestOnly) {
  if (!has_front_end()) GTEST_SKIP() << "built without Node: there is no front end";
  compute(store_, tiny_manifest("  pressure_Pa: 700\n"));
  const nlohmann::json packings = data_of(make()).at("packings");
  ASSERT_EQ(packings.size(), 1U);
}

TEST_F(ReportOfRuns, HasTheTableOfRunsInBothForms) {
  const Table table = run_table(store_, {}, RowPer::run, {}).table;
  ASSERT_EQ(table.rows.size(), 2U);
  for (const std::string& html : {make(), make(drawings())}) {
    EXPECT_EQ(count(html, "<tbody data-row="), 2U);
    for (const char* key : {"fluid", "grains"}) {
      EXPECT_EQ(count(html, "data-key=\"" + std::string(key) + "\""), 1U) << key;
    }
    for (const auto& row : table.rows) {
      const nlohmann::json phi = json_of(row[table.place("phi")]);
      EXPECT_EQ(count(html, "data-value=\"" + phi.dump() + "\""), 1U) << phi;
    }
  }
}

TEST_F(ReportOfRuns, ShowsTheStateOfEachStepOfTheWorkflow) {
  const Manifest longer = parse_manifest(tiny_manifest("  cycles: 5\n", kBothFluids), "tiny.yaml");
  declare(store_, expand(longer));
  const Stage run = runs_of_kind(store_, "shear").front();
  store_.start_stage(run.id, {}, store_.checkpoints(run.id).back().sha256);
  store_.fail_stage(run.id, "blew up");
  const std::string html = make(drawings());
  const std::size_t begin = html.find("<ol class=\"workflow\"");
  ASSERT_NE(begin, std::string::npos);
  const std::string flow = html.substr(begin, html.find("</ol>", begin) - begin);
  for (const char* part : {"<h4>Manifest</h4>", ">tiny.yaml</a>", "</span> 1 done",
                           "</span> 1 failed", "</span> 1 waiting", "</span> 7 stored",
                           "</span> 6 or fewer to come", "<a href=\"#figure-tiny.S2\">S2</a>"}) {
    EXPECT_EQ(count(flow, part), 1U) << part << "\n" << flow;
  }
}

TEST_F(ReportOf, CallsVariantsByTheirLabels) {
  compute(store_, tiny_manifest("", kBothFluids + "labels: {\"fluid=still\": water at rest}\n"));
  const std::string html = make();
  EXPECT_EQ(count(html, "data-key=\"variant\""), 1U);
  EXPECT_GE(count(html, "water at rest"), has_front_end() ? 4U : 1U);
  if (has_front_end()) {
    EXPECT_EQ(data_of(html).at("packings")[1].at("label").get<std::string>().find("water"), 0U);
  }
}

TEST_F(ReportOfRuns, AllowsOnlyItsOwnScriptAndHasNoneWithDrawings) {
  const std::string html = make();
  EXPECT_TRUE(has(html, "Content-Security-Policy\" content=\"default-src 'none';"));
  EXPECT_EQ(count(html, "script-src 'sha256-"), has_front_end() ? 1U : 0U);
  // Plotly has addresses of its own in strings; the policy lets it ask for none.
  const std::string markup = html.substr(0, html.rfind("<script>"));
  for (const char* link : {"src=\"http", "href=\"http", "url(http", "@import"}) {
    EXPECT_EQ(count(markup, link), 0U) << link;
  }
  const Report made = report(drawings());
  const std::string& drawn = made.html;
  EXPECT_FALSE(made.interactive);
  EXPECT_EQ(count(drawn, "<script"), 0U);
  EXPECT_EQ(count(drawn, "<img alt=\"S2"), 2U) << (made.notes.empty() ? "" : *made.notes.begin());
}

TEST_F(ReportOfRuns, SaysWhichDrawingsFailed) {
  const TemporaryFolder programs;
  write_script(programs.path() / "gnuplot", "#!/bin/sh\nkill -KILL $$\n");
  const Variable first("PATH", programs.path().string() + ":" + std::getenv("PATH"));
  const Report made = report(drawings());
  ASSERT_EQ(made.undrawn.size(), 2U);
  EXPECT_EQ(*made.undrawn.begin(),
            "figure tiny/S2: gnuplot could not draw S2a.svg: it was ended by signal 9");
  EXPECT_EQ(count(made.html, "No drawing: gnuplot could not draw S2b.svg"), 1U);
  EXPECT_TRUE(report().undrawn.empty() || !has_front_end());
}

TEST_F(ReportOfRuns, NamesDamagedCheckpoints) {
  const std::string run = runs_of_kind(store_, "shear").front().id;
  truncate_file(store_.folder() / store_.checkpoints(run).front().file);
  const Report made = report();
  ASSERT_EQ(made.damage.size(), 1U);
  EXPECT_TRUE(has(made.html, "Left out: "));
}

// Its measures are cached, so that figures and tables do not read it.
TEST_F(ReportOfRuns, NamesDamagedCheckpointsThatAreMeasured) {
  make();
  const std::string run = runs_of_kind(store_, "shear").back().id;
  truncate_file(store_.folder() / store_.checkpoints(run).front().file);
  const Report made = report();
  EXPECT_EQ(made.damage.size(), has_front_end() ? 1U : 0U);
  EXPECT_EQ(made.figures, report(drawings()).figures);
}

// A record of the table of runs that cannot be read is damage, not a remark.
TEST_F(ReportOfRuns, NamesDamagedMeasures) {
  make();
  DerivedCache cache(store_.folder());
  std::vector<DerivedObject> forged;
  {
    const sqlite::Database kept(store_.folder() / DerivedCache::kFile, Access::write);
    sqlite::Statement row(kept, "SELECT checkpoint, measure, version FROM derived");
    while (row.step()) {
      DerivedObject& object = forged.emplace_back();
      row.get(object.key.checkpoint, object.key.measure, object.key.version);
      object.content = encode_result("none");
    }
  }
  cache.put(forged);
  EXPECT_FALSE(report().damage.empty());
}

TEST_F(ReportOf, NeedsAnExperiment) {
  EXPECT_THROW(make(), NotFound);
}

// Such a store is never written by this program, and may be handed to it.
TEST_F(ReportOf, ShowsMarkupAsText) {
  const std::string evil = "</script><script>alert(1)</script><img src=x onerror='a()'>\"&<!--";
  Stage run;
  run.memberships.emplace_back().ask.target_cycles = 1;
  run.memberships[0].place.manifest = store_.register_manifest(
      "# " + evil + "\n", evil + ".yaml",
      {{"experiment", evil}, {"question", evil}, {"figures", {evil, "S2"}}});
  run.id = std::string(64, 'a');
  run.kind = evil;
  run.resolved = {{evil, evil}};
  run.grains = 10;
  run.memberships[0].place.experiment = evil;
  run.memberships[0].place.scale = evil;
  run.memberships[0].place.variant = evil;
  run.memberships[0].place.swept = {{evil, evil}};
  store_.declare_stage(run);
  store_.start_stage(run.id, {{"host", evil}, {"build", {{"version", evil}, {"flags", evil}}}});
  store_.fail_stage(run.id, evil);

  for (const ReportOptions& options : {ReportOptions(), drawings()}) {
    const std::string html = make(options);
    const bool interactive = options.interactive && has_front_end();
    EXPECT_EQ(count(html, "<script>alert"), 0U);
    EXPECT_EQ(count(html, "<img"), interactive ? 0U : count(html, "<img alt"));
    EXPECT_EQ(count(html, "<script"), interactive ? 2U : 0U);
    EXPECT_EQ(count(html, "</script"), interactive ? 2U : 0U);
    EXPECT_GT(count(html, "&lt;script&gt;alert(1)"), 5U);
    EXPECT_EQ(data_of(html).is_object(), interactive);
  }
}

}  // namespace
}  // namespace shearcell::test
