#include "tools/app/validation/published_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/base/check.h"
#include "sim/base/error.h"

namespace leviosim::tools {

std::string_view reference_text(std::string_view name) {
  for (const base::BuiltinFile& file : builtin_references())
    if (file.name == name) return file.text;
  check_failed(fmt::format("no reference file {}", name), SourceLine::current());
}

void for_each_row(const std::string& file, std::string_view text,
                  const std::vector<std::string>& titles,
                  const std::function<void(const base::CsvRow&)>& visit) {
  base::CsvReader reader(file, base::Separator::comma, titles, std::string(text));
  const base::CsvRow* row = reader.next();
  if (row == nullptr)
    throw InputError(fmt::format("{}: expected the titles {}", file, fmt::join(titles, ",")));
  for (std::size_t i = 0; i < titles.size(); ++i)
    if (row->text(i) != titles[i]) row->fail(i, fmt::format("expected the title {}", titles[i]));
  while ((row = reader.next()) != nullptr) visit(*row);
}

}  // namespace leviosim::tools
