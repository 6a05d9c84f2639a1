// What if, for people and programs: text of 80 columns, CSV, and a page with bars.
#pragma once

#include <string>
#include <vector>

#include "tools/app/html_report/page_json.h"
#include "tools/app/study/whatif/whatif.h"

namespace leviosim::tools {

/// A row a variant with its reason below; the first is the run as it is.
std::string whatif_table(const std::vector<VariantResult>& results);

/// A bar a variant: the time of a mean frame, and its energy.
std::string whatif_bars(const std::vector<VariantResult>& results);

/// The same ranked: time gained per area and per energy; what changes nothing, and what cannot be.
std::string advice_text(const std::vector<VariantResult>& results);

/// In a sentence: the variant that cannot run, else the fastest.
std::string whatif_conclusion(const std::vector<VariantResult>& results);

/// In one line, why a variant takes another time: "waiting for code -11.2 ms, most in EPnP RANSAC".
std::string reason_of(const VariantResult& base, const VariantResult& variant);

std::string whatif_csv(const std::vector<VariantResult>& results);

/// @param title   of the page
/// @param summary  lines
Json whatif_page(const std::string& title, const std::string& summary,
                 const std::vector<VariantResult>& results);

}  // namespace leviosim::tools
