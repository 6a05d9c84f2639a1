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

// What the LEVIO paper says of accuracy: that of its golden model, and that of other estimators.
// Both tables, of tools/app/validation/published, are part of the program.

/// A row of paper_accuracy.csv: sequence (EuRoC's name), profile, width, height, chosen_by (ate or
/// relative), figure (ate or relative), value, unit, source.
struct PaperAccuracy {
  enum class Figure { ate, relative };  ///< [m]; [%] over kPaperLengthM

  std::string sequence;
  std::string profile;
  traces::ImageSize size;
  Figure chosen_by;
  Figure figure;
  double value;
  std::string source;
};

/// Of the paper's sub-trajectories.
inline constexpr double kPaperLengthM = 40;

/// @throws InputError with file and line
std::vector<PaperAccuracy> parse_paper_accuracy(const std::string& file, std::string_view text);

std::vector<PaperAccuracy> paper_accuracy();

/// A row of other_accuracy.csv: sequence (EuRoC's name), estimator, loop_closure (yes or no),
/// width, height, value, unit (m), source.
struct OtherAccuracy {
  std::string sequence;
  std::string estimator;
  bool closes_loops = false;
  traces::ImageSize size;
  double ate_m = 0;
  std::string source;
};

/// @throws InputError with file and line
std::vector<OtherAccuracy> parse_other_accuracy(const std::string& file, std::string_view text);

std::vector<OtherAccuracy> other_accuracy();

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
                                       const std::vector<PaperAccuracy>& paper);

// The rows of an ablation as text, Markdown and JSON.

/// Beside the paper's values where it has such, with the protocol below.
std::string ablation_text(const BatchPlan& plan, const std::vector<AblationRow>& rows);
Json ablation_json(const BatchPlan& plan, const std::vector<AblationRow>& rows);

/// Absolute errors by sequence: those of the ablation, what the paper says of LEVIO, and others'.
/// Empty if nothing was published of the ablation's sequences.
std::string accuracy_comparison(const BatchPlan& plan, const std::vector<AblationRow>& rows,
                                const std::vector<PaperAccuracy>& paper,
                                const std::vector<OtherAccuracy>& others);

/// `leviosim ablate` (tools/commands/commands.h).
Command add_ablate_command(CLI::App& app, const Words& words);

}  // namespace leviosim::tools
