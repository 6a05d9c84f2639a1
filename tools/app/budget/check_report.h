// What a check found, as text of 80 columns, as JSON, and as CI servers read it.
#pragma once

#include <string>

#include "tools/app/budget/check.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/report/statistic_list.h"

namespace leviosim::tools {

/// A line per limit, and for those that are not met by how much, where, why, reason and owner, as
/// parts of a screen, with a verdict at their end.
/// @param next  what to do about limits that are not met
Printout check_printout(const CheckResult& result, std::vector<std::string> next);

Json check_json(const CheckResult& result);

// What a check found, as CI servers read it: JUnit, annotations of GitHub, a code quality report of
// GitLab. No times of the host: the same findings are the same bytes.

/// A suite per section, a case per limit and statistic.
std::string junit_xml(const CheckResult& result);

/// A comment on a pull request: the verdicts of the run, what of the limits is not met and why,
/// what moved against the baseline, and all limits folded away.
/// @param baseline  may be null
std::string markdown_comment(const CheckResult& result, const RunRecord& run,
                             const RunRecord* baseline);

/// "::error file=…,line=…,title=…::…" for each limit that is not met.
std::string github_annotations(const CheckResult& result);

/// The JSON that GitLab reads as an artifact of the kind codequality.
std::string gitlab_report(const CheckResult& result);

}  // namespace leviosim::tools
