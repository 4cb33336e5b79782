// Error against run time: the fronts of a study, and the best choice for an error that is asked for.
//
// The CSV is that of validation plan 4.5, one row per run: what was chosen (integrator, law, ttd, precision, step ...), times and errors.
#pragma once

#include <string>
#include <vector>

namespace scree {

struct ErrorVsTimeOptions {
  std::vector<std::string> files;
  std::string folder;
  std::vector<std::string> cases;  ///< only these; empty: all
  int words = 0;  ///< a case is that many first words of its column; 0: all of them, or two where every row has a name of its own
  std::vector<std::string> errors;   ///< columns; empty: every error column with two numbers or more in a case
  std::string time = "wall_median";  ///< column
  std::vector<double> targets;       ///< errors to find the best choice for; empty: whole powers of ten within reach
};

/// One run of a study.
struct StudyRow {
  std::string choice;          ///< the columns that vary within the case, as "integrator kdk-dlm, step 1e-5"
  std::string series;          ///< those of them that are words: one line of the chart
  double time = 0, error = 0;  ///< [s], as the column
  bool on_front = false;       ///< no other is both as fast and as exact, and better in one
};

/// Marks the front: rows that no other row beats. Of equal rows the first stays.
void mark_front(std::vector<StudyRow>& rows);
/// The fastest row with an error of at most `target`; -1 when there is none.
int best_for(const std::vector<StudyRow>& rows, double target);

struct ErrorVsTimeResult {
  std::string text;  ///< table of the best choices
  std::vector<std::string> files;
};
/// Writes fronts.csv, best.csv and for each case and error CASE-ERROR.svg/.png.
/// Fails: InputError (no such column, no number, named with file and line), SystemError.
ErrorVsTimeResult write_error_vs_time(const ErrorVsTimeOptions& options);

}  // namespace scree
