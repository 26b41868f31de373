// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of the report as HTML. Texts from a store or a file are escaped here.
#pragma once

#include <string>

#include "experiments/report/report_data.hpp"

namespace shearcell {

/// The whole page: markup, style, data and, if it is interactive, the front end. The same store and
/// options give the same bytes with the same program (drawings also need the same gnuplot).
std::string report_page(const ReportData& data);

/// The experiment's question, verdict, figures and runs.
std::string experiment_html(const ReportData& data, const ReportExperiment& experiment);

/// A row for each run: its parameters and results.
std::string run_table_html(const ReportData& data, const ReportExperiment& experiment);

/// A figure: its panels, claims and lineage.
std::string figure_html(const ReportData& data, const ReportFigure& figure);
std::string figure_link(const ReportFigure& figure);

/// A plot (or its placeholder, if the page is interactive) and its numbers.
std::string panel_html(const ReportData& data, const ReportPanel& panel);

/// The lineage of a figure, collapsed.
std::string lineage_html(const ReportData& data, const ReportFigure& figure);

/// Every run with its attempts, builds and checkpoints, and the manifests.
std::string runs_html(const ReportData& data);

/// The beginning of an id. It is cut before it is escaped, since an escape must stay whole.
std::string brief(const std::string& id);
/// A link to the part of the page about a run. The text has so many digits of its id.
std::string run_link(const std::string& id, std::size_t digits = 12);

/// The experiment's question, or its name if the manifest has no question.
std::string question_html(const ReportExperiment& experiment);

/// "agrees", "differs" or "undecided" with a mark that needs no colour; "" for nothing.
std::string ruling_html(std::optional<Ruling> ruling);

/// The verdict on all figures of the experiment; nothing if they have no claims.
std::optional<Ruling> ruling_of(const ReportData& data, const ReportExperiment& experiment);

}  // namespace shearcell
