// The paper's ablation: every profile at every image size over every sequence, each with several
// seeds, condensed to a row per combination.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/app/cli/command_line.h"
#include "tools/app/study/accuracy_study.h"
#include "tools/app/study/engine.h"
#include "traces/datasets/image_preparation.h"

namespace leviosim::tools {

// What the LEVIO paper says of accuracy, of its golden model and of other estimators:
// tools/app/validation/published/accuracy.csv, which is part of the program.

/// A row of it: sequence (EuRoC's name), estimator, loop_closure (yes or no), width, height,
/// chosen_by (ate or relative; empty for other estimators), figure (ate or relative), value, unit,
/// source.
struct PublishedAccuracy {
  enum class Figure { ate, relative };  ///< [m]; [%] over kPaperLengthM

  std::string sequence;
  std::string estimator;  ///< of the golden model: the profile
  bool closes_loops = false;
  traces::ImageSize size;
  std::optional<Figure> chosen_by;  ///< of the golden model only
  Figure figure = Figure::ate;
  double value = 0;
  std::string source;

  /// Whether it is an absolute error, with parameters chosen by that where any were.
  bool is_ate() const {
    return figure == Figure::ate && chosen_by.value_or(Figure::ate) == Figure::ate;
  }
};

/// Of the paper's sub-trajectories.
inline constexpr double kPaperLengthM = 40;

/// @throws InputError with file and line
std::vector<PublishedAccuracy> parse_accuracy(const std::string& file, std::string_view text);

std::vector<PublishedAccuracy> published_accuracy();

// The rows of an ablation.

struct AblationRow {
  std::string sequence;  ///< empty: the mean over all sequences
  traces::ImageSize size;
  std::string profile;
  /// Over seeds and folders of the sequence; medians only in a mean. Of relative errors, runs is 0
  /// where the path is too short for any.
  Spread ate;       ///< [m]
  Spread relative;  ///< [%]
  struct Paper {
    double value;
    traces::ImageSize size;  ///< of the images it was found with
  };
  std::optional<Paper> paper_ate;  ///< at the same size, else at the paper's largest
  std::optional<Paper> paper_relative;
  std::optional<double> least_completion;
  std::vector<std::string> protocols;  ///< each once
};

/// In the order of rows: sequence_names(), then sizes, then profiles; folders and seeds inside.
std::vector<Point> ablation_runs(const BatchPlan& plan);

/// A row per sequence, size and profile, and with several sequences the means over them.
std::vector<AblationRow> ablation_rows(const BatchPlan& plan, const std::vector<Point>& runs,
                                       const std::vector<RunOutcome>& outcomes,
                                       const std::vector<PublishedAccuracy>& published);

// The rows of an ablation as text, Markdown and JSON.

/// Beside the paper's values where it has such, with the protocol below.
std::string ablation_text(const BatchPlan& plan, const std::vector<AblationRow>& rows);
Json ablation_json(const BatchPlan& plan, const std::vector<AblationRow>& rows);

/// Absolute errors by sequence: those of the ablation, what the paper says of LEVIO, and others'.
/// Empty if nothing was published of the ablation's sequences.
std::string accuracy_comparison(const BatchPlan& plan, const std::vector<AblationRow>& rows,
                                const std::vector<PublishedAccuracy>& published);

/// `leviosim ablate` (tools/commands/commands.h).
Command add_ablate_command(CLI::App& app, const Words& words);

}  // namespace leviosim::tools
