#pragma once

#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "studies/drawing/figure.h"

namespace gladstone::inline report {

/// Blocks of a report, independent of the output format. Texts are plain; the writers escape them.
struct Paragraph {
  std::string text;
};
struct TextList {
  std::vector<std::string> items;
};
/// Text reproduced from a file.
struct Verbatim {
  std::string summary;  ///< title shown in place of the collapsed text
  std::string text;
};
/// A table cell; with a number, it is sorted by the number and shows it rounded.
struct TableCell {
  std::string text;
  std::optional<double> number = std::nullopt;

  /// Formats four significant digits; "unknown" for NaN.
  static TableCell of(double number);
  /// Formats displacements or errors to 1e-5 px, below the resolution of any measurement; "unknown" for NaN.
  static TableCell px(double number);
};
struct TextTable {
  std::string caption;
  std::vector<std::string> header;
  std::vector<std::vector<TableCell>> rows;
  bool filtered = false;  ///< true for tables long enough to require a search field
};
/// A chart that report.js draws: one of its figures, by the reader's choice; in Markdown, replaced by its description.
struct Chart {
  std::string kind;  ///< name of the chart
  std::string title;
  std::string alt;  ///< description in numbers
  std::vector<NamedFigure> figures;
};
/// Two frames that can be shown alternately at the same position.
struct FramePictures {
  std::string title, alt;
  std::string first_name, second_name;
  std::string first_png, second_png;  ///< contents of the PNG files
};
/// A figure stored as a separate file.
struct FigureFile {
  std::string path;  ///< relative to the report
  std::string alt;
};
using ReportBlock = std::variant<Paragraph, TextList, Verbatim, TextTable, Chart, FramePictures, FigureFile>;

struct ReportSection {
  std::string title;
  std::vector<ReportBlock> blocks;
};

struct ReportPage {
  std::string title;
  std::string question;
  std::vector<std::string> findings;
  std::vector<ReportSection> sections;
  std::map<std::string, std::string> data;  ///< results for programs that read the report: JSON by its name
  /// files of vectors whose header declares another number of vectors, or that are likely not read as they were written
  std::vector<std::string> doubtful;
};

/// Formats the report as a single HTML file that works offline: styles, scripts (d3, with its licence) and data are
/// embedded.
std::string html_page(ReportPage const& page);
/// Formats the report as Markdown, without interactive elements.
std::string markdown_page(ReportPage const& page);

}  // namespace gladstone::inline report
