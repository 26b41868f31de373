// SPDX-License-Identifier: GPL-3.0-or-later
// The plot language of manifests: expressions, series, axis labels, published numbers, panels, and
// claims with published numbers.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "analysis/expression.hpp"
#include "analysis/plot.hpp"
#include "analysis/plots.hpp"
#include "provenance/errors.hpp"
#include "tests/analysis/made_up_runs.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

/// Three amplitudes and two periods with three seeds each; phi = amplitude + period/1000.
std::vector<FrameRun> runs_of_sweep() {
  std::vector<FrameRun> runs;
  for (const double amplitude : {0.02, 0.04, 0.08}) {
    for (const double period : {0.5, 2.0}) {
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        FrameRun run = made_up_run("amplitude_rad", amplitude, seed, 3, [&](int n, Measures& m) {
          m.numbers["phi"] = amplitude + period / 1000 + 1e-6 * static_cast<double>(seed);
          m.numbers["mean_overlap_d"] = n;
        });
        run.place.swept["period_s"] = period;
        run.place.variant = fmt::format("amplitude_rad={},period_s={}", amplitude, period);
        run.name = fmt::format("A={} rad, T={} s", amplitude, period);
        run.stage.id = fmt::format("{}/{}", run.place.variant, seed);
        runs.push_back(std::move(run));
      }
    }
  }
  return runs;
}

Table drawing_of(const PlotSpec& plot) {
  return plot_figure(plot).make(runs_of_sweep()).tables.at(0);
}

std::vector<std::string> titles_of(const Table& table) {
  std::vector<std::string> titles;
  for (const Series& one : table.chart.series) titles.push_back(plain_text(one.title));
  return titles;
}

double result_of(const std::string& text, const ValueOf& names = {}) {
  return evaluator_of(text)(names);
}

TEST(Expression, IsArithmetic) {
  const auto a_is = [](double a) {
    return [a](const std::string& name) { return name == "a" ? a : std::nan(""); };
  };
  EXPECT_EQ(result_of("1/a_s", [](const std::string&) { return 4.0; }), 0.25);
  EXPECT_EQ(result_of("-a^2 + 2*(a - 1)", a_is(3)), -5);
  EXPECT_EQ(result_of("sqrt(16) + max(1, a, 2) + ln(exp(1))", a_is(7)), 12);
  EXPECT_NEAR(result_of("2*pi/a", a_is(2)), std::acos(-1.0), 1e-15);
  EXPECT_EQ(result_of("1e-3*2.5E+2"), 0.25);
  EXPECT_EQ(names_in("stress_xy_Pa/(2*pi*max(phi, phi)) + 1e5"),
            (std::vector<std::string>{"stress_xy_Pa", "phi"}));
  EXPECT_EQ(names_in("phi"), std::vector<std::string>{"phi"});
  // Long texts, which are no expressions, overflow no stack.
  for (const char c : {'a', '1', ' ', '+'}) {
    const std::string text(1'000'000, c);
    names_in(text);
    EXPECT_EQ(wrong_in_expression(text), "is longer than 200 bytes");
  }
  EXPECT_FALSE(is_expression("msd_1_cycle_d2"));
  EXPECT_TRUE(is_expression("-phi") && is_expression("1/phi") && is_expression("2"));
}

TEST(Expression, WithoutAFiniteResultIsNotANumber) {
  for (const char* text : {"1/0", "0/0", "sqrt(-1)", "ln(0)", "exp(1000)", "10^400", "asin(2)"}) {
    EXPECT_TRUE(std::isnan(result_of(text))) << text;
  }
  for (const double value : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    EXPECT_TRUE(std::isnan(result_of("0*a", [&](const std::string&) { return value; }))) << value;
  }
}

TEST(Expression, OfAnyTextIsSoundOrRefused) {
  for (const std::string& bad :
       {std::string("1+"),          std::string(" "),         std::string("(1"),
        std::string("1)"),          std::string("1,2"),       std::string("min()"),
        std::string("a b"),         std::string("2a"),        std::string("a=1"),
        std::string("a;1"),         std::string("\"a\""),     std::string("a?1:2"),
        std::string("a&&1"),        std::string("system(1)"), std::string("sin 1"),
        std::string("1e"),          std::string("1..2"),      std::string("0x10"),
        std::string("1e999"),       std::string("2^^3"),      std::string("a[0]"),
        std::string("phi\xC2\xA0"), std::string("rint(1)"),   std::string("1,5*a"),
        std::string(201, '('),      std::string("\0", 1)}) {
    EXPECT_NE(wrong_in_expression(bad), "") << bad;
  }
  EXPECT_EQ(wrong_in_expression("exec(1)"), "uses the unknown function exec");
  EXPECT_EQ(wrong_in_expression(std::string(99, '(') + "1" + std::string(99, ')')), "");
  // Every short text of these characters: no crash, and what is accepted can be evaluated.
  const std::string characters = "1a.(),+-^e ";
  std::size_t sound = 0, refused = 0;
  for (std::size_t code = 0; code < 14641; ++code) {
    std::string text;
    for (std::size_t rest = code, k = 0; k < 4; ++k, rest /= 11) text += characters[rest % 11];
    if (!wrong_in_expression(text).empty()) {
      ++refused;
    } else {
      result_of(text, [](const std::string&) { return 2.0; });
      ++sound;
    }
  }
  std::printf("%zu sound, %zu refused\n", sound, refused);
  EXPECT_GT(sound, 500U);
  EXPECT_GT(refused, 5000U);
}

TEST(Expression, DoesNotDependOnTheLocale) {
  const std::string before = std::setlocale(LC_ALL, nullptr);
  for (const char* locale : {"de_DE.UTF-8", "fr_FR.UTF-8", "C"}) {
    std::setlocale(LC_ALL, locale);
    EXPECT_EQ(result_of("1.5*2"), 3) << locale;
    EXPECT_NE(wrong_in_expression("1,5*2"), "") << locale;
  }
  std::setlocale(LC_ALL, before.c_str());
}

TEST(Formula, IsItalicWithLoweredAndRaisedText) {
  const auto parts = [](const char* text) {
    std::string all;
    for (const TextPart& part : formula(text).parts) {
      all += part.style.empty() ? part.text : "<" + part.style + ":" + part.text + ">";
    }
    return all;
  };
  EXPECT_EQ(parts("shear cycle $n$"), "shear cycle <i:n>");
  EXPECT_EQ(parts("$v_{fluid} = v_0$"), "<i:v><sub:fluid> = <i:v><sub:0>");
  EXPECT_EQ(parts("2.6×10$^{−5}$ s"), "2.6×10<sup:−5> s");
  EXPECT_EQ(parts("$ϕ_−$ a_b"), "<i:ϕ><sub:−> a_b");
  for (const char* odd : {"$", "$$", "$_$", "$_", "$^{", "$x_{y", "_{}", ""}) {
    EXPECT_NO_THROW(formula(odd)) << odd;
  }
}

TEST(OwnPlot, TakesExpressionsOfParametersAndMeasures) {
  const Table by_frequency = drawing_of({.name = "own",
                                         .columns = {{"phi"}},
                                         .x = "1/period_s",
                                         .xlabel = "frequency $f$ [Hz]",
                                         .cycle = 2});
  EXPECT_EQ(by_frequency.chart.series.size(), 3U) << "a curve for each amplitude";
  EXPECT_EQ(plain_text(by_frequency.chart.x.name), "frequency f [Hz]");
  EXPECT_TRUE(has(to_csv(by_frequency), "\namplitude_rad=0.02,0.5,0.022002,"))
      << to_csv(by_frequency);
  EXPECT_TRUE(has(to_csv(by_frequency), "\namplitude_rad=0.02,2,0.020502,"));
  const Table both = drawing_of(
      {.name = "own", .columns = {{"1000*(phi - amplitude_rad)/period_s"}}, .x = "cycle"});
  EXPECT_EQ(both.chart.series.size(), 6U);
  for (const Series& series : both.chart.series) {
    for (const ChartPoint& p : points_of(series)) EXPECT_NEAR(p.y, 1, 0.005);
  }
  const Table strange = drawing_of({.name = "own",
                                    .columns = {{"1/(mean_overlap_d - 2)"}},
                                    .x = "2*cycle",
                                    .show = Show::scatter});
  ASSERT_EQ(strange.chart.series.size(), 18U) << "every run";
  EXPECT_EQ(strange.chart.series[0].points.size(), 3U) << "1/0 at cycle 2";
  EXPECT_EQ(strange.chart.series[0].points[2].x, 6);
  EXPECT_EQ(strange.chart.series[0].join, Join::none);
  EXPECT_NE(strange.chart.series[0].point, 0);
}

TEST(OwnPlot, TakesTheNeedsOfItsExpression) {
  const Figure figure = plot_figure({.name = "own", .columns = {{"stress_xy_Pa/msd_1_cycle_d2"}}});
  const std::vector<std::string> names = {"stress_xy_Pa", "msd_1_cycle_d2"};
  EXPECT_EQ(figure.needs, providers_of(names));
  EXPECT_EQ(figure.needs.size(), 2U);
}

TEST(OwnPlot, DrawsSeriesAsStated) {
  const PlotSpec plot{
      .name = "own",
      .columns = {{"phi"}},
      .x = "period_s",
      .by = "amplitude_rad",
      .series = {
          {.where = {{"amplitude_rad", 0.08}}, .label = "large $A$", .colour = "vermilion"},
          {.where = {{"amplitude_rad", 0.02}}, .colour = "#123456", .marker = "open_diamond"}}};
  const Table table = drawing_of(plot);
  EXPECT_EQ(titles_of(table),
            (std::vector<std::string>{"large A", "amplitude_rad=0.02", "amplitude_rad=0.04"}))
      << "in the order of the series, then the others";
  EXPECT_EQ(table.chart.series[0].colour, "#d55e00");
  EXPECT_EQ(table.chart.series[1].colour, "#123456");
  EXPECT_EQ(table.chart.series[1].point, 12);
  EXPECT_EQ(table.chart.series[2].colour, "#0072b2") << "vermilion by its rank, which is taken";
  PlotSpec traces = plot;
  traces.show = Show::traces;
  traces.x = "cycle";
  traces.by.clear();
  traces.series = {{.where = {{"amplitude_rad", 0.08}, {"period_s", 2.0}}, .colour = "purple"}};
  EXPECT_EQ(drawing_of(traces).chart.series[0].colour, "#cc79a7");
}

TEST(OwnPlot, HoldsTheStatedStylesOfOtherPlots) {
  const std::vector<PlotSpec> plots = {
      {.name = "stated",
       .columns = {{"phi"}},
       .x = "1/period_s",
       .by = "amplitude_rad",
       .series = {{.where = {{"amplitude_rad", 0.02}}, .colour = "blue", .marker = "open_circle"},
                  {.where = {{"amplitude_rad", 0.08}}, .colour = "vermilion"}}},
      {.name = "panels", .columns = {{"phi"}}, .by = "amplitude_rad", .panel = "period_s"},
      {.name = "variants", .columns = {{"phi"}}},
      {.name = "other",
       .columns = {{"phi"}},
       .x = "period_s",
       .by = "amplitude_rad",
       .series = {{.where = {{"amplitude_rad", 0.04}}, .colour = "blue"}}}};
  const std::vector<Figure> figures = own_figures(plots, {}, {});
  const auto colours = [&](std::size_t k, std::size_t panel) {
    const FigureResult made = figures[k].make(runs_of_sweep());
    std::map<std::string, std::string> by_title;
    for (const Series& one : made.tables.at(panel).chart.series) {
      by_title[plain_text(one.title)] = one.colour;
      const bool circle = one.colour == "#0072b2" && one.point == 6;
      EXPECT_EQ(circle, k < 2 && has(plain_text(one.title), "0.02")) << k;
    }
    return by_title;
  };
  const std::map<std::string, std::string> stated = {{"amplitude_rad=0.02", "#0072b2"},
                                                     {"amplitude_rad=0.04", "#009e73"},
                                                     {"amplitude_rad=0.08", "#d55e00"}};
  EXPECT_EQ(colours(0, 0), stated);
  EXPECT_EQ(colours(1, 0), stated);
  EXPECT_EQ(colours(1, 1), stated);
  for (const auto& [title, colour] : colours(2, 0)) {
    for (const char* amplitude : {"0.02", "0.04", "0.08"}) {
      if (!has(title, fmt::format("A={} ", amplitude))) continue;
      EXPECT_EQ(colour, stated.at(fmt::format("amplitude_rad={}", amplitude)))
          << "the colour of both periods, with two symbols";
    }
  }
  EXPECT_EQ(colours(3, 0).at("amplitude_rad=0.04"), "#0072b2") << "states another one";
  EXPECT_EQ(colours(3, 0).at("amplitude_rad=0.08"), "#d55e00");
  EXPECT_NE(colours(3, 0).at("amplitude_rad=0.02"), "#0072b2");
}

TEST(OwnPlot, AveragesOnlyOverTheRunsThatItSelects) {
  const Table table = drawing_of(
      {.name = "own", .columns = {{"phi"}}, .where = {{"period_s", 2.0}}, .by = "amplitude_rad"});
  EXPECT_EQ(table.chart.series.size(), 3U);
}

TEST(OwnPlot, WritesListsAndRangesInWords) {
  const nlohmann::json between = {{"min", 0.05}, {"max", 0.1}}, fluids = {"still", "cell"};
  EXPECT_EQ(words_of({{"amplitude_rad", between}, {"fluid", fluids}}),
            "amplitude_rad 0.05 to 0.1, fluid=still or cell");
  EXPECT_EQ(words_of({{"amplitude_rad", {{"min", 0.06}}}, {"grains", {{"max", 600}}}}),
            "amplitude_rad >= 0.06, grains <= 600");
  EXPECT_EQ(words_of({{"fluid", "still"}, {"grains", 600}}), "fluid=still, grains=600");
}

TEST(OwnPlot, ShowsPublishedNumbers) {
  const Table table = drawing_of(
      {.name = "own",
       .columns = {{"phi"}},
       .x = "amplitude_rad",
       .published = {
           {.label = "Jin", .source = "S C", .value = 0.05, .error = 0.01},
           {.label = "Smith", .source = "a book", .points = {{0.02, 0.03, 0.001}, {0.08, 0.04}}}}});
  const std::vector<ReferenceLine>& lines = table.chart.lines;
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_NEAR(lines[0].at, 0.04, 1e-12);
  EXPECT_NEAR(lines[1].at, 0.06, 1e-12);
  const Series& points = table.chart.series.back();
  ASSERT_EQ(points.points.size(), 2U);
  EXPECT_EQ(points.points[0].y_error, 0.001);
  EXPECT_EQ(points.points[1].y_error, std::nullopt);
  const std::string script = gnuplot_script(table);
  for (const char* entry :
       {"title 'Jin 0.05 ± 0.01'", "title 'Smith'", "0.03,,0.001", "first 0.04"}) {
    EXPECT_TRUE(has(script, entry)) << script;
  }
  const std::vector<Table> tables = {table};
  EXPECT_TRUE(
      has(caption_of("A title", tables), " Published: Jin 0.05 ± 0.01: S C; Smith: a book."));
  const std::vector<Table> twice = {table, table};
  const std::string caption = caption_of("A title", twice);
  EXPECT_EQ(caption.find("Published"), caption.rfind("Published")) << caption;
  EXPECT_EQ(drawing_of({.name = "own",
                        .columns = {{"phi"}},
                        .published = {{.label = "exact", .source = "S C", .value = 0.05}}})
                .chart.lines.size(),
            1U);
}

TEST(OwnPlot, HasAPanelForEachValueWithEqualRanges) {
  const PlotSpec plot{.name = "own", .columns = {{"phi"}}, .x = "cycle", .panel = "period_s"};
  const NameVariants names = [](const std::vector<nlohmann::json>& variants) {
    std::map<nlohmann::json, std::string> named;
    for (const auto& variant : variants) named[variant] = "<" + words_of(variant) + ">";
    return named;
  };
  const FigureResult result = plot_figure(plot, names).make(runs_of_sweep());
  ASSERT_EQ(result.tables.size(), 2U);
  EXPECT_EQ(result.tables[0].name, "own_1");
  EXPECT_EQ(result.tables[1].name, "own_2");
  EXPECT_EQ(plain_text(result.tables[0].chart.title), "<period_s=0.5>");
  EXPECT_EQ(titles_of(result.tables[1]),
            (std::vector<std::string>{"<amplitude_rad=0.02>", "<amplitude_rad=0.04>",
                                      "<amplitude_rad=0.08>"}));
  EXPECT_EQ(result.tables[0].rows.size(), 12U);
  EXPECT_TRUE(to_csv(result.tables[1]).starts_with("variant,period_s,cycle,phi_mean,")) << "CSV";
  EXPECT_EQ(result.tables[1].rows.at(0).at(1), TableCell(2.0));
  for (const Table& table : result.tables) {  // from 0.0205 to 0.082, and some room
    const double low = table.chart.y.low.value(), high = table.chart.y.high.value();
    EXPECT_TRUE(low < 0.0205 && low > 0.015) << low;
    EXPECT_TRUE(high > 0.082 && high < 0.087) << high;
    EXPECT_EQ(low, result.tables[0].chart.y.low);
    EXPECT_EQ(high, result.tables[0].chart.y.high);
  }
  EXPECT_THROW(plot_figure({.name = "own", .columns = {{"phi"}}, .by = "amplitude_rad"})
                   .make(runs_of_sweep()),
               UsageError)
      << "it would average over the periods";
  EXPECT_NO_THROW(
      plot_figure({.name = "own", .columns = {{"phi"}}, .by = "amplitude_rad", .panel = "period_s"})
          .make(runs_of_sweep()));
  PlotSpec compared = plot;
  compared.published = {{.label = "Jin", .source = "S C", .value = 0.74}};
  for (const Table& table : plot_figure(compared).make(runs_of_sweep()).tables) {
    EXPECT_GT(table.chart.y.high, 0.74) << "published lines are in the range";
  }
}

TEST(OwnPlot, OfOneFigureAreItsPanels) {
  const std::vector<PlotSpec> plots = {
      {.name = "a", .columns = {{"phi"}}, .figure = "pair"},
      {.name = "alone", .columns = {{"phi"}}},
      {.name = "b", .columns = {{"mean_overlap_d"}}, .figure = "pair"}};
  const std::vector<ClaimSpec> claims = {
      {.id = "c",
       .figure = "pair",
       .compare = "phi",
       .cycles = {{1, 2}},
       .between = {{{{"amplitude_rad", 0.02}, {"period_s", 2.0}}, nlohmann::json::object()}},
       .published = PublishedSpec{.label = "", .source = "S C", .value = 0.022},
       .margin = 0.001}};
  const std::vector<Figure> figures = own_figures(plots, claims, {});
  ASSERT_EQ(figures.size(), 2U);
  EXPECT_EQ(figures[0].name, "pair");
  EXPECT_EQ(figures[1].name, "alone");
  EXPECT_EQ(figures[0].within, std::nullopt);
  const FigureResult pair = figures[0].make(runs_of_sweep());
  ASSERT_EQ(pair.tables.size(), 2U);
  EXPECT_EQ(pair.tables[1].name, "b");
  ASSERT_EQ(pair.verdicts.size(), 1U);
  EXPECT_EQ(pair.verdicts[0].ruling, Ruling::agrees);
}

TEST(OwnClaim, ComparesWithAPublishedNumber) {
  ClaimSpec claim{
      .id = "own",
      .compare = "1000*phi",
      .cycles = {{2, 2}},
      .between = {{{{"amplitude_rad", 0.02}, {"period_s", 2.0}}, nlohmann::json::object()}},
      .published = PublishedSpec{.label = "", .source = "S C", .value = 22.0, .error = 0.1},
      .margin = 0.01};
  const auto verdict = [&] { return claim_figure(claim).make(runs_of_sweep()).verdicts.at(0); };
  EXPECT_EQ(verdict().ruling, Ruling::agrees);
  EXPECT_NEAR(verdict().estimate.value().value, 0.002, 1e-9);
  EXPECT_EQ(verdict().text,
            "own: 1000*phi at cycle 2 is as published, 22 ± 0.1 (S C), for A=0.02 rad, T=2 s");
  claim.published->value = 23;
  EXPECT_EQ(verdict().ruling, Ruling::differs);
  claim.relative = true;
  claim.margin = 0.1;
  EXPECT_EQ(verdict().ruling, Ruling::agrees) << "within 10 %";
  EXPECT_NEAR(verdict().estimate.value().value, 22.002 / 23 - 1, 1e-9);
  claim.is = Relation::lower;
  EXPECT_EQ(verdict().ruling, Ruling::refuted);
  EXPECT_TRUE(verdict().text.starts_with(
      "own: 1000*phi at cycle 2 is lower by more than 10 % than published, 23 ± 0.1 (S C), for "));
  claim.margin = 0.07;
  EXPECT_TRUE(verdict().text.starts_with("own: 1000*phi at cycle 2 is lower by more than 7 % "))
      << verdict().text;
  claim.margin = 0.01;
  EXPECT_EQ(verdict().ruling, Ruling::supported);
  claim.is = Relation::higher;
  claim.compare = "-1000*phi";
  claim.published->value = -23;
  EXPECT_EQ(verdict().ruling, Ruling::supported) << "-22 is higher than -23";
  EXPECT_NEAR(verdict().estimate.value().value, 1 - 22.002 / 23, 1e-9);
  claim.statement = "B.9: they are equal";
  EXPECT_EQ(verdict().text, "B.9: they are equal");
  claim.between[0] = nlohmann::json::object();
  const std::string refusal = message_of<UsageError>([&] { verdict(); });
  EXPECT_TRUE(has(refusal, "claim own: there are 6 variants; `of` must select one variant. Add "))
      << refusal;
  EXPECT_TRUE(has(refusal, "amplitude_rad: 0.0") && has(refusal, "` or other values."));
  claim.between[0] = {{"amplitude_rad", 0.06}};
  EXPECT_EQ(verdict().note, "no run with amplitude_rad=0.06 has a checkpoint of cycle 2");
}

TEST(OwnPlot, HasFurtherColumnsWithNamesOfTheirOwn) {
  const Table table = drawing_of(
      {.name = "own",
       .columns = {
           {"phi"}, {"phi_uncorrected", "phi_u"}, {"mean_overlap_d", "overlap"}, {"time_s"}}});
  EXPECT_TRUE(to_csv(table).starts_with(
      "variant,cycle,phi_mean,phi_standard_error,phi_u_mean,phi_u_standard_error,overlap_mean_d,"
      "overlap_standard_error_d,time_mean_s,time_standard_error_s,runs\n"))
      << to_csv(table);
}

TEST(OwnPlot, HasColumnsWithoutSpecialCharacters) {
  for (const auto& [measure, column, name, unit] :
       {std::array{"kinetic_energy_per_grain_m_d2_per_s2",
                   "kinetic_energy_per_grain_mean_m_d2_per_s2", "kinetic energy per grain",
                   "m d²/s²"},
        {"force_residual_P_d2", "force_residual_mean_P_d2", "force residual", "P d²"},
        {"msd_1_cycle_d2", "msd_1_cycle_mean_d2", "msd 1 cycle", "d²"},
        {"shear_rate_per_s", "shear_rate_mean_per_s", "shear rate", "1/s"},
        {"raised_stiffness_N_per_m", "raised_stiffness_mean_N_per_m", "raised stiffness", "N/m"}}) {
    const Table table = drawing_of({.name = "own", .columns = {{measure}}});
    EXPECT_EQ(table.columns.at(2), column);
    EXPECT_EQ(plain_text(table.chart.y.name), name);
    EXPECT_EQ(plain_text(table.chart.y.unit), unit);
  }
}

/// Packings 1 to 3 with 100 (the reference), 10 and 20 steps of our engine and 20 of LAMMPS. phi of
/// the reference depends on the packing; that of other steps differs from it by 0.4/steps^2, in
/// packing 2 in the other direction. A run takes a second for each step and packing.
std::vector<FrameRun> runs_of_steps() {
  std::vector<FrameRun> runs;
  for (const auto& [engine, steps] :
       {std::pair("shearcell", 100), {"shearcell", 10}, {"shearcell", 20}, {"lammps", 20}}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const double error = steps == 100 ? 0 : (seed == 2 ? -0.4 : 0.4) / (steps * steps);
      FrameRun run =
          made_up_run("steps_per_cycle", steps, seed, 2, [&, of = steps](int n, Measures& m) {
            m.numbers["phi"] = 0.6 + 0.01 * static_cast<double>(seed) + n * error;
            m.numbers["mean_overlap_d"] = of;
          });
      run.place.swept["engine"] = engine;
      run.place.variant = fmt::format("engine={},steps_per_cycle={}", engine, steps);
      run.stage.id = fmt::format("{}/{}", run.place.variant, seed);
      run.packing = fmt::format("packing {}", seed);
      run.core_time_s =
          steps * static_cast<double>(seed) * (engine == std::string("lammps") ? 9 : 1);
      runs.push_back(std::move(run));
    }
  }
  return runs;
}

const PlotSpec kErrors = {.name = "own",
                          .columns = {{"phi"}},
                          .minus = {{"steps_per_cycle", 100}},
                          .x = "core_time_s",
                          .by = "engine",
                          .show = Show::rms,
                          .log = LogAxes::xy,
                          .cycle = 1};

Table errors_of(const std::vector<FrameRun>& runs, const PlotSpec& plot = kErrors) {
  return plot_figure(plot).make(runs).tables.at(0);
}

/// Expects a row of the table: the variant, x, y with its error (none of one run), and the number
/// of runs.
void expect_row(const Table& table, const std::string& variant, double x, double y, double error,
                std::size_t runs) {
  const auto number = [](const TableCell& value) {
    const auto* whole = std::get_if<std::int64_t>(&value);
    const auto* real = std::get_if<double>(&value);
    return whole != nullptr ? static_cast<double>(*whole) : real != nullptr ? *real : 0;
  };
  for (const TableRow& row : table.rows) {
    if (std::get<std::string>(row[0]) != variant || std::abs(number(row[1]) - x) > 1e-9) continue;
    EXPECT_NEAR(number(row[2]), y, 1e-6 * std::abs(y));
    EXPECT_NEAR(number(row[3]), error, 1e-6 * std::abs(y));
    EXPECT_EQ(number(row[4]), static_cast<double>(runs));
    return;
  }
  ADD_FAILURE() << "no row " << variant << "," << x << " in\n" << to_csv(table);
}

TEST(OwnPlot, IsADifferenceFromTheRunWithTheSamePacking) {
  const Table table = errors_of(runs_of_steps());
  EXPECT_TRUE(to_csv(table).starts_with(
      "variant,core_time_s,phi_difference_rms,phi_difference_standard_error,runs,cycle\n"));
  EXPECT_EQ(table.rows.size(), 3U) << "without the reference";
  expect_row(table, "engine=lammps", 360, 0.001, 0, 3);
  expect_row(table, "engine=shearcell", 20, 0.004, 0, 3);
  expect_row(table, "engine=shearcell", 40, 0.001, 0, 3);
  EXPECT_EQ(plain_text(table.chart.y.name), "rms difference in volume fraction");
  EXPECT_EQ(plain_text(table.chart.x.name), "core time");
  EXPECT_EQ(plain_text(table.chart.x.unit), "s");
  EXPECT_EQ(table.chart.note,
            "At cycle 1. Differences from steps_per_cycle=100 with the same packing");
  EXPECT_EQ(std::ranges::count(plot_figure(kErrors).needs, "cost"), 1);

  PlotSpec against_cycle = kErrors;
  against_cycle.x = "cycle";
  against_cycle.by.clear();
  const std::string variant = "engine=shearcell;steps_per_cycle=10";
  expect_row(errors_of(runs_of_steps(), against_cycle), variant, 2, 0.008, 0, 3);
  against_cycle.show = Show::mean;
  expect_row(errors_of(runs_of_steps(), against_cycle), variant, 2, 0.008 / 3, 0.016 / 3, 3);

  PlotSpec of_runs = kErrors;
  of_runs.show = Show::scatter;
  std::size_t points = 0;
  for (const Series& series : errors_of(runs_of_steps(), of_runs).chart.series) {
    points += series.points.size();
  }
  EXPECT_EQ(points, 9U) << "each run at its own core time";

  PlotSpec of_costs = kErrors;
  of_costs.columns = {{"core_time_s"}};
  of_costs.x = "steps_per_cycle";
  const Table costs = errors_of(runs_of_steps(), of_costs);
  EXPECT_EQ(costs.columns[2], "core_time_difference_rms_s");
  bool found = false;  // 90, 180 and 270 s less
  for (const Series& series : costs.chart.series) {
    for (const ChartPoint& p : points_of(series)) {
      found = found || (p.x == 10 && std::abs(p.y - 90 * std::sqrt(14.0 / 3)) < 1e-9);
    }
  }
  EXPECT_TRUE(found) << to_csv(costs);
}

// Runs of one packing that differ by noise are no independent ones.
TEST(OwnPlot, IsADifferenceFromTheMeanOfSeveralPartners) {
  std::vector<FrameRun> runs = runs_of_steps();
  FrameRun clone = runs[0];  // the reference of packing 1
  clone.stage.id += "/clone";
  clone.place.seed = 11;
  for (CheckpointMeasures& checkpoint : clone.checkpoints) {
    checkpoint.measures.numbers["phi"] += 0.002;
  }
  runs.push_back(clone);
  PlotSpec mean = kErrors;
  mean.show = Show::mean;
  mean.log = LogAxes::none;
  const Table table = errors_of(runs, mean);
  EXPECT_EQ(table.rows.size(), 3U);
  // 0.003, -0.004 and 0.004.
  expect_row(table, "engine=shearcell", 20, 0.001, std::sqrt((4 + 25 + 9) / 6.0) / 1000, 3);
}

TEST(OwnPlot, LeavesOutRunsWithoutAPartner) {
  std::vector<FrameRun> runs = runs_of_steps();
  runs.erase(runs.begin());  // the reference of packing 1
  const Table table = errors_of(runs);
  expect_row(table, "engine=shearcell", 25, 0.004, 0, 2);
  EXPECT_TRUE(table.chart.note.ends_with("same packing; 3 of 9 runs have no run to subtract"))
      << table.chart.note;
  for (FrameRun& run : runs) run.packing.clear();
  EXPECT_TRUE(errors_of(runs).rows.empty()) << "nobody knows their packings";
  EXPECT_TRUE(errors_of(runs).chart.note.ends_with("9 of 9 runs have no run to subtract"));
  runs = runs_of_steps();
  runs.erase(runs.begin(), runs.begin() + 3);
  EXPECT_TRUE(errors_of(runs).rows.empty());
  EXPECT_TRUE(errors_of(runs).chart.note.ends_with("No run has steps_per_cycle=100"));
}

TEST(OwnPlot, LeavesOutValuesThatAreNotThere) {
  std::vector<FrameRun> runs = runs_of_steps();
  runs[0].checkpoints[1].measures.numbers.erase("phi");  // of the reference of packing 1
  runs[4].checkpoints[1].measures.numbers.erase("phi");  // of 10 steps, packing 2
  const Table table = errors_of(runs);
  expect_row(table, "engine=shearcell", 30, 0.004, 0, 1);
  expect_row(table, "engine=lammps", 450, 0.001, 0, 2);
}

TEST(OwnPlot, ComparesUnfinishedRunsAtTheCyclesOfBoth) {
  PlotSpec last = kErrors;
  last.cycle.reset();
  std::vector<FrameRun> runs = runs_of_steps();
  runs[1].checkpoints.pop_back();  // the reference of packing 2 has not reached cycle 2
  expect_row(errors_of(runs, last), "engine=shearcell", 20, 0.004, 0, 3);  // cycle 1, that of all
  last.cycle = 2;
  // Packings 1 and 3, also in the mean of the core time.
  expect_row(errors_of(runs, last), "engine=shearcell", 20, 0.008, 0, 2);
  runs = runs_of_steps();
  runs[3].checkpoints.pop_back();  // 10 steps, packing 1
  expect_row(errors_of(runs, last), "engine=shearcell", 25, 0.008, 0, 2);
  for (FrameRun& run : runs) run.checkpoints.clear();
  EXPECT_TRUE(errors_of(runs, last).rows.empty());
}

TEST(OwnPlot, SaysThatADifferenceOfZeroIsNotOnALogarithmicAxis) {
  PlotSpec at_start = kErrors;
  at_start.cycle = 0;
  const std::vector<Table> tables = {errors_of(runs_of_steps(), at_start)};
  EXPECT_EQ(tables[0].rows.size(), 3U);
  expect_row(tables[0], "engine=shearcell", 20, 0, 0, 3);
  const std::string caption = caption_of("Errors", tables);
  EXPECT_TRUE(has(caption, "Values that are not positive are not drawn: 3.")) << caption;
  EXPECT_NO_THROW(gnuplot_script(tables[0]));
}

TEST(OwnPlot, RefusesAReferenceOfSeveralVariants) {
  PlotSpec of_engine = kErrors;
  of_engine.minus = {{"engine", "shearcell"}};
  EXPECT_EQ(message_of<UsageError>([&] { errors_of(runs_of_steps(), of_engine); }),
            "plot own: 3 variants have engine=shearcell; `minus` must select one variant.");
  of_engine.listed = true;
  EXPECT_TRUE(errors_of(runs_of_steps(), of_engine).rows.empty());
  EXPECT_TRUE(errors_of(runs_of_steps(), of_engine)
                  .chart.note.ends_with("Several variants have engine=shearcell"));
}

/// phi rises by 0.001 a cycle; the percentage by one point a cycle from `first` on.
FrameRun crystallizing(const char* fluid, std::uint64_t seed, int first) {
  return made_up_run("fluid", fluid, seed, 60, [=](int n, Measures& m) {
    m.numbers["phi"] = 0.6 + 0.001 * n;
    m.numbers["crystalline_percent"] = std::max(0, n - first);
    m.numbers["largest_crystallite"] = n;
  });
}

std::vector<FrameRun> runs_of_fluids() {
  std::vector<FrameRun> runs;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    runs.push_back(crystallizing("still", seed, 10 + static_cast<int>(seed)));
    runs.push_back(crystallizing("cell", seed + 10, 30 + static_cast<int>(seed)));
  }
  return runs;
}

const ClaimSpec kOfFluids = {.id = "own",
                             .compare = "crystalline_percent",
                             .between = {{{{"fluid", "cell"}}, {{"fluid", "still"}}}},
                             .margin = 1};

Verdict verdict_of(const ClaimSpec& claim) {
  return claim_figure(claim).make(runs_of_fluids()).verdicts.at(0);
}

TEST(OwnClaim, ComparesMeansOverAWindowOfPhi) {
  ClaimSpec claim = kOfFluids;
  claim.phi = {{0.64, 0.65}};
  const Verdict verdict = verdict_of(claim);
  EXPECT_NEAR(verdict.estimate.value().value, -20, 1e-9) << "20 cycles later, a point a cycle";
  EXPECT_EQ(verdict.quantity,
            "difference in percentage crystalline, mean over phi from 0.64 to 0.65");
  claim.phi = {{0.64, 0.70}};
  EXPECT_TRUE(has(verdict_of(claim).note, "8 of 8 runs end too early for phi from 0.64 to 0.7"));
}

TEST(OwnClaim, ComparesTheCyclesAtWhichALevelIsReached) {
  ClaimSpec claim = kOfFluids;
  claim.reaches = 5;
  claim.is = Relation::higher;
  claim.margin = 0.1;
  const Verdict verdict = verdict_of(claim);
  EXPECT_EQ(verdict.ruling, Ruling::supported);
  EXPECT_EQ(verdict.text,
            "own: the cycle of crystalline_percent >= 5 is later by more than a factor of 1.07 for "
            "fluid=cell than for fluid=still");
  EXPECT_TRUE(has(verdict.note, "first: median cycle 37.5 (0 of 4 runs end before the event)"))
      << verdict.note;
  claim.reaches = 28;  // from cycle 59 to 62
  EXPECT_TRUE(has(verdict_of(claim).note, "(2 of 4 runs end before the event)"));
  claim.between[1] = {{"fluid", "none"}};
  EXPECT_TRUE(has(result_of(verdict_of(claim)),
                  "cycle of crystalline_percent >= 28 (log-rank test): not measured, margin: 1.1 "
                  "times, 0 runs"))
      << result_of(verdict_of(claim));
}

TEST(OwnClaim, WithoutAMarginTakesThePublishedNumberAsABound) {
  ClaimSpec claim = kOfFluids;
  claim.cycles = {{0, 0}};
  claim.compare = "phi";
  claim.between[1] = nlohmann::json::object();
  claim.published = PublishedSpec{.label = "", .source = "S C", .value = 0.61};
  claim.margin = 0;
  claim.is = Relation::lower;
  EXPECT_EQ(verdict_of(claim).ruling, Ruling::supported);
  EXPECT_NEAR(verdict_of(claim).estimate.value().value, 0.6, 1e-12);
  EXPECT_EQ(verdict_of(claim).margin, 0.61);
  EXPECT_EQ(verdict_of(claim).text,
            "own: phi at cycle 0 is lower than published, 0.61 (S C), for fluid=cell");
  claim.is = Relation::higher;
  EXPECT_EQ(verdict_of(claim).ruling, Ruling::refuted);
}

TEST(OwnClaim, OfOneSideSaysWhatItComparesWith) {
  ClaimSpec claim = kOfFluids;
  claim.compare = "phi";
  claim.cycles = {{2, 2}};
  claim.estimator = "spread_of_variants";
  const Verdict alone = verdict_of(claim);
  EXPECT_EQ(alone.text,
            "own: standard deviation between variants of phi at cycle 2 is within 1 of 0, for "
            "fluid=cell");
  EXPECT_TRUE(has(alone.note, "at least two variants")) << alone.note;
  claim.between[0] = nlohmann::json::object();
  claim.is = Relation::higher;
  EXPECT_TRUE(verdict_of(claim).text.ends_with(" is higher by more than 1 than 0"));
  EXPECT_FALSE(has(verdict_of(claim).note, "at least two variants"));
}

TEST(OwnClaim, CountsTheRunsThatCrystallizeDuringItsCycles) {
  ClaimSpec claim = kOfFluids;
  claim.cycles = {{1, 15}};
  EXPECT_FALSE(has(verdict_of(claim).note, "onset")) << "16 grains are critical";
  claim.cycles = {{1, 20}};
  EXPECT_TRUE(has(verdict_of(claim).note, "8 of all 8 runs have their onset before cycle 20"));
}

TEST(OwnClaim, IsLeftOutIfItIsOptionalAndASideHasNoRuns) {
  ClaimSpec claim = kOfFluids;
  claim.cycles = {{1, 15}};
  claim.optional = true;
  EXPECT_EQ(verdict_of(claim).estimate.has_value(), true);
  claim.between[1] = {{"fluid", "none"}};
  EXPECT_TRUE(claim_figure(claim).make(runs_of_fluids()).verdicts.empty());
  claim.optional = false;
  EXPECT_EQ(verdict_of(claim).note, "no run with fluid=none has a checkpoint of cycles 1 to 15");
}

TEST(OwnFigure, SimulatesOnlyTheCyclesOfItsPartsThatNeedIt) {
  using Cycles = std::array<std::uint64_t, 2>;
  ClaimSpec claim = kOfFluids;
  claim.figure = "f";
  claim.compare = "phi_at_rest";
  claim.cycles = {{1, 15}};
  const PlotSpec plot{.name = "p", .columns = {{"phi"}}, .figure = "f"};
  const auto simulated = [&](const PlotSpec& of) {
    const std::vector<PlotSpec> plots = {of};
    const std::vector<ClaimSpec> claims = {claim};
    return own_figures(plots, claims, {}).at(0).simulated;
  };
  EXPECT_EQ(simulated(plot), Cycles({1, 15}));
  EXPECT_EQ(find_figure("B5")->simulated, Cycles({1, 15}));
  EXPECT_EQ(simulated({.name = "p", .columns = {{"phi_at_rest"}}, .figure = "f"}), std::nullopt);
}

}  // namespace
}  // namespace shearcell::test
