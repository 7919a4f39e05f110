// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "page/chart.hpp"
#include "page/history_panels.hpp"

namespace hexaplast::output {

/// A page of HTML in one file: it asks for nothing from anywhere (its content security policy says so too), follows the
/// reader's light or dark scheme, and is made for paper, desks and phones. Charts are there without scripts; with them
/// they show their values where the pointer is.
///
/// What comes from users is escaped by the functions here; `markup` is taken as it is.
class HtmlPage {
 public:
  enum class Kind { kWhole, kFrame };  ///< a frame stands in another page: it shows no title, and the viewer fills it
  explicit HtmlPage(std::string_view title, Kind kind = Kind::kWhole);

  void add(std::string_view markup);
  void heading(std::string_view words);  ///< of a section
  void paragraph(std::string_view words, std::string_view css_class = "");

  /// A chart with its legend and a line that says more, which may be empty.
  void chart(const Panel& panel, std::string_view note = "");

  /// A viewer of runs, beside each other where there are two, that shows itself where scripts and WebGL 2 are there.
  /// data: of each run, as read_viewer_data() gives it.
  void viewer(const std::vector<std::string>& data);

  /// Rows of words; the first cell of a row is its head. `columns`: heads of the columns, or none.
  void table(const std::vector<std::string>& columns, const std::vector<std::vector<std::string>>& rows,
             std::string_view css_class = "");

  /// The whole page.
  std::string finish() &&;

 private:
  std::string text_;
  bool has_viewer_ = false;
};

/// A frame with the viewer of a run; data: as read_viewer_data() gives it.
std::string viewer_page(std::string_view title, const std::string& data);

/// As a data URI, to stand in a page.
std::string data_uri(std::string_view media_type, std::string_view bytes);

/// Words as one line of a POSIX shell.
std::string shell_line(const std::vector<std::string>& words);

}  // namespace hexaplast::output
