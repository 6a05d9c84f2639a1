// A study of many points as data of a report: the points as a table of what was set and what came
// out of it, curves over one of the settings, and the axes that the scatter begins with.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tools/app/table/json.h"
#include "tools/app/table/table.h"

namespace leviosim::tools {

/// Figures over a setting, a line for each value of another.
struct StudyCurves {
  std::string x;
  std::string series;  ///< empty: one line
  std::vector<std::string> y;
  std::string hint = {};   ///< in place of one about medians
  bool from_zero = true;   ///< where the axes of the figures begin
  std::string names = {};  ///< column that names the values 0, 1, … of x; empty: they are numbers
  std::map<std::string, std::vector<std::size_t>> marks = {};  ///< of a figure, points to look at
};

/// A bar for each row.
struct StudyBars {
  std::string of;  ///< names the rows
  std::vector<std::string> figures;
  std::string title = {};  ///< of one chart of figures that are changes; empty: a chart for each
};

/// A table that answers, beside that of the points.
struct StudyTable {
  std::string title;
  Table table;  ///< as people see it
};

/// What a study found: a box with a mark, as the verdict of a run has.
struct StudyBox {
  std::optional<bool> good;
  std::string mark;
  std::string sentence;
  std::vector<std::string> lines;
};

struct StudyPage {
  std::string title;
  std::vector<StudyBox> boxes = {};
  std::string summary;  ///< lines below the boxes; of a conclusion the page makes a box
  std::vector<StudyTable> found = {};
  Table points{{}};  ///< a row per point
  /// Of the table of points, those with key and title; empty: as the table has them.
  std::vector<Head> columns = {};
  std::optional<StudyCurves> curves = {};
  std::optional<StudyBars> bars = {};
  std::map<std::string, double> limits = {};  ///< column → what it should not exceed
  std::string x;                              ///< of the scatter
  std::string y;
  std::string colour;  ///< setting that colours the points; may be empty
};

/// The data of a page: report_json() without runs.
Json study_report(const StudyPage& page);

}  // namespace leviosim::tools
