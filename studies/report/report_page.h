#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace gladstone {

/// What a report consists of, whatever it is written as. Texts are plain; whoever writes them escapes them.
struct Paragraph {
  std::string text;
};
struct TextList {
  std::vector<std::string> items;
};
/// Text as it stands in a file.
struct Verbatim {
  std::string summary;  ///< what it is; the text itself is folded away behind it
  std::string text;
};
/// A cell that holds a number is sorted by it, and shows it rounded.
struct TableCell {
  std::string text;
  std::optional<double> number = std::nullopt;

  /// Four significant digits; "unknown" for NaN.
  static TableCell of(double number);
  /// Displacements and their errors: hundred-thousandths of a pixel, which no measurement tells from 0.
  static TableCell px(double number);
};
struct TextTable {
  std::string caption;
  std::vector<std::string> header;
  std::vector<std::vector<TableCell>> rows;
  bool filtered = false;  ///< long enough to be searched
};
/// A chart that report.js draws from the report's data.
struct Chart {
  std::string kind;  ///< a key of `charts` in report.js
  std::string title;
  std::string alt;  ///< what it shows, in numbers
};
/// Two frames that can be held against each other in turn.
struct FramePictures {
  std::string title, alt;
  std::string first_name, second_name;
  std::string first_png, second_png;  ///< bytes
};
/// A figure that the report holds; as Markdown it is told by its words.
struct Picture {
  std::string title;
  std::string alt;  ///< what it shows, in numbers
  std::string png;  ///< bytes
};
/// A figure that is a file beside the report.
struct FigureFile {
  std::string path;  ///< relative to the report
  std::string alt;
};
using ReportBlock = std::variant<Paragraph, TextList, Verbatim, TextTable, Chart, FramePictures, Picture, FigureFile>;

struct ReportSection {
  std::string title;
  std::vector<ReportBlock> blocks;
};

struct ReportPage {
  std::string title;
  std::string question;
  std::vector<std::string> findings;
  std::vector<ReportSection> sections;
  nlohmann::json data;  ///< what report.js draws charts from
};

/// One file that works without a network: styles, scripts (d3, with its licence) and data are in it.
std::string html_page(ReportPage const& page);
/// The same as Markdown, without what takes a browser.
std::string markdown_page(ReportPage const& page);

}  // namespace gladstone
