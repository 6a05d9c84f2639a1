// What a check found, as CI servers read it: JUnit, annotations of GitHub, a code quality report of
// GitLab. No times of the host: the same findings are the same bytes.
#pragma once

#include <string>

#include "tools/app/budget/check.h"
#include "tools/app/record/record.h"

namespace leviosim::tools {

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
