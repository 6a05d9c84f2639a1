// What the project's files refer to exists: sections of FACTS.md and PARAMETERS.md, keys of
// sources, and the targets of relative links in Markdown pages.
//
// A citation is the name of the page and the slug of the section, such as PARAMETERS.md#input,
// in comments, in the sources of platform files, in tables and in pages. Left out: whether the
// section says what is claimed, links to other sites, and links inside code.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/support/paths.h"
#include "tests/support/text_lines.h"

namespace leviosim::tests {
namespace {

namespace fs = std::filesystem;

/// Faults, one line each: "file:line: what".
using Faults = std::vector<std::string>;
/// The anchors of a page: slugs of its headings.
using Slugs = std::set<std::string>;

/// Pages that are cited by name alone, and where they lie.
const std::map<std::string, std::string> kPages{{"FACTS.md", "platform_models/FACTS.md"},
                                                {"PARAMETERS.md", "workload/PARAMETERS.md"}};

/// What older citations named, which is no part of the project.
const std::vector<std::string> kForbidden{
    "hw_facts",         "levio_parameters",       "levio_release_facts",       "kernel_references",
    "shared/reference", "reference/paper_tables", "reference/timeline_format", "fact sheet"};

std::string read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  EXPECT_TRUE(in.good()) << file;
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// Sources, tables, scripts and pages of the project's folders, and the pages beside them, sorted.
std::vector<fs::path> project_files() {
  const std::set<std::string> kinds{".h",   ".cpp", ".yaml", ".yml",   ".md", ".csv",
                                    ".txt", ".sh",  ".py",   ".cmake", ".cff"};
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(source_folder()))
    if (entry.is_regular_file() && entry.path().extension() == ".md") files.push_back(entry.path());
  for (const char* folder : {"sim", "workload", "platform_models", "traces", "tests", "tools"})
    for (const auto& entry : fs::recursive_directory_iterator(source_folder() / folder))
      if (entry.is_regular_file() && kinds.count(entry.path().extension().string()) != 0)
        files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// The lines of a page with code taken out: fenced blocks become empty lines, `code` becomes ``.
std::vector<std::string> prose_of(const std::string& page) {
  std::vector<std::string> lines = lines_of(page);
  bool fenced = false;
  for (std::string& line : lines) {
    const bool fence = line.compare(0, 3, "```") == 0;
    if (fence) fenced = !fenced;
    if (fence || fenced) line.clear();
    std::string kept;
    bool code = false;
    for (const char c : line) {
      if (c == '`') code = !code;
      if (!code || c == '`') kept += c;
    }
    line = kept;
  }
  return lines;
}

/// The anchor that GitHub gives a heading: lower case, hyphens for spaces, without punctuation.
std::string slug_of(std::string_view heading) {
  std::string slug;
  for (const char c : heading) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == ' ') slug += '-';
    if (std::isalnum(byte) != 0 || c == '-' || c == '_' || byte >= 0x80)
      slug += static_cast<char>(std::tolower(byte));
  }
  return slug;
}

Slugs slugs_of(const std::string& page) {
  Slugs slugs;
  bool fenced = false;
  for (const std::string& line : lines_of(page)) {
    if (line.compare(0, 3, "```") == 0) fenced = !fenced;
    const std::size_t level = line.find_first_not_of('#');
    if (fenced || level == 0 || level == std::string::npos || line[level] != ' ') continue;
    const std::string slug = slug_of(std::string_view(line).substr(level + 1));
    std::string free = slug;
    for (int i = 1; !slugs.insert(free).second; ++i) free = slug + "-" + std::to_string(i);
  }
  return slugs;
}

std::string at(const std::string& name, std::size_t index, const std::string& what) {
  return name + ":" + std::to_string(index + 1) + ": " + what;
}

/// What stands behind the '#' of a citation.
std::string slug_behind(std::string_view text) {
  const auto end = std::find_if(text.begin(), text.end(), [](const unsigned char c) {
    return std::isalnum(c) == 0 && c != '-' && c != '_';
  });
  return std::string(text.begin(), end);
}

/// Citations of sections that the pages do not have, and of what is not in the project.
/// @param count  to which the citations found are added
Faults citation_faults(const std::string& name, const std::string& text,
                       const std::map<std::string, Slugs>& pages, int& count) {
  Faults faults;
  const std::vector<std::string> lines = lines_of(text);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (const std::string& word : kForbidden)
      if (lines[i].find(word) != std::string::npos)
        faults.push_back(at(name, i, "cites '" + word + "', which is not in the project"));
    for (const auto& [page, slugs] : pages) {
      const std::string start = page + "#";
      for (std::size_t found = lines[i].find(start); found != std::string::npos;
           found = lines[i].find(start, found + 1)) {
        ++count;
        const std::string slug =
            slug_behind(std::string_view(lines[i]).substr(found + start.size()));
        if (slugs.count(slug) == 0) faults.push_back(at(name, i, "no section " + start + slug));
      }
    }
  }
  return faults;
}

/// Targets of the links of a page, with the index of their lines.
std::vector<std::pair<std::size_t, std::string>> links_of(const std::string& page) {
  std::vector<std::pair<std::size_t, std::string>> links;
  const std::vector<std::string> lines = prose_of(page);
  for (std::size_t i = 0; i < lines.size(); ++i)
    for (std::size_t found = lines[i].find("]("); found != std::string::npos;
         found = lines[i].find("](", found + 2)) {
      const std::size_t end = lines[i].find_first_of(") ", found);
      links.emplace_back(i, lines[i].substr(found + 2, end - found - 2));
    }
  return links;
}

/// Relative links of a page to files or headings that do not exist.
Faults link_faults(const std::string& name, const fs::path& file, const std::string& text) {
  Faults faults;
  for (const auto& [line, link] : links_of(text)) {
    if (link.find("://") != std::string::npos || link.compare(0, 7, "mailto:") == 0) continue;
    const std::size_t hash = link.find('#');
    const std::string path = link.substr(0, hash);
    const fs::path target = path.empty() ? file : file.parent_path() / path;
    if (!path.empty() && !fs::exists(target))
      faults.push_back(at(name, line, "no file " + link));
    else if (hash != std::string::npos && target.extension() == ".md" &&
             slugs_of(path.empty() ? text : read(target)).count(link.substr(hash + 1)) == 0)
      faults.push_back(at(name, line, "no heading " + link));
  }
  return faults;
}

std::map<std::string, Slugs> cited_pages() {
  std::map<std::string, Slugs> pages;
  for (const auto& [page, file] : kPages) pages[page] = slugs_of(read(source_folder() / file));
  return pages;
}

std::string in_project(const fs::path& file) {
  return file.lexically_relative(source_folder()).generic_string();
}

/// First cells of the rows of a section's tables; "a, b" are two.
std::set<std::string> first_cells(const std::string& page, const std::string& heading) {
  std::set<std::string> cells;
  bool inside = false;
  for (const std::string& line : lines_of(page)) {
    if (line.compare(0, 2, "##") == 0) inside = line == "## " + heading;
    if (!inside || line.compare(0, 2, "| ") != 0) continue;
    std::istringstream keys(line.substr(2, line.find(" |") - 2));
    for (std::string key; keys >> key;) cells.insert(key.substr(0, key.find(',')));
  }
  return cells;
}

/// Keys in the section `sources` of a platform file: lines "  key: text" below it.
std::vector<std::pair<std::size_t, std::string>> source_keys(const std::string& yaml) {
  std::vector<std::pair<std::size_t, std::string>> keys;
  bool inside = false;
  const std::vector<std::string> lines = lines_of(yaml);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!lines[i].empty() && std::isalpha(static_cast<unsigned char>(lines[i][0])) != 0)
      inside = lines[i].compare(0, 8, "sources:") == 0;
    const std::size_t colon = lines[i].find(": ");
    if (inside && lines[i].compare(0, 2, "  ") == 0 && colon != std::string::npos)
      keys.emplace_back(i, lines[i].substr(2, colon - 2));
  }
  return keys;
}

TEST(Citations, NameSectionsThatExist) {
  const std::map<std::string, Slugs> pages = cited_pages();
  Faults faults;
  int count = 0;
  for (const fs::path& file : project_files()) {
    if (file.filename() == fs::path(__FILE__).filename()) continue;  // has faulty ones, below
    const Faults here = citation_faults(in_project(file), read(file), pages, count);
    faults.insert(faults.end(), here.begin(), here.end());
  }
  EXPECT_GT(count, 200);  // all folders were read
  EXPECT_EQ(joined(faults), "");
}

TEST(Citations, LinksOfPagesResolve) {
  Faults faults;
  std::size_t count = 0;
  for (const fs::path& file : project_files()) {
    if (file.extension() != ".md") continue;
    const std::string text = read(file);
    count += links_of(text).size();
    const Faults here = link_faults(in_project(file), file, text);
    faults.insert(faults.end(), here.begin(), here.end());
  }
  EXPECT_GT(count, 50u);
  EXPECT_EQ(joined(faults), "");
}

TEST(Citations, KeysOfPlatformFilesAreExplained) {
  const std::set<std::string> known =
      first_cells(read(source_folder() / kPages.at("FACTS.md")), "Sources");
  Faults faults;
  std::size_t count = 0;
  for (const fs::path& file : project_files()) {
    if (file.extension() != ".yaml" || in_project(file).compare(0, 16, "platform_models/") != 0)
      continue;
    for (const auto& [line, key] : source_keys(read(file))) {
      ++count;
      if (known.count(key) == 0)
        faults.push_back(at(in_project(file), line, "FACTS.md#sources has no key " + key));
    }
  }
  EXPECT_GT(count, 50u);
  EXPECT_EQ(joined(faults), "");
}

TEST(Citations, KeysOfTheFactsAreExplained) {
  const std::string page = read(source_folder() / kPages.at("FACTS.md"));
  const std::set<std::string> known = first_cells(page, "Sources");
  Faults faults;
  const std::vector<std::string> lines = prose_of(page);
  for (std::size_t i = 0; i < lines.size(); ++i)
    for (std::size_t open = lines[i].find('['); open != std::string::npos;
         open = lines[i].find('[', open + 1)) {
      const std::size_t close = lines[i].find(']', open);
      if (close == std::string::npos || lines[i].compare(close, 2, "](") == 0) continue;
      const std::string inside = lines[i].substr(open + 1, close - open - 1);
      const std::string key = inside.substr(0, inside.find_first_of(", "));
      if (known.count(key) == 0) faults.push_back(at("FACTS.md", i, "no source " + key));
    }
  EXPECT_EQ(joined(faults), "");
}

TEST(Citations, FaultsAreFound) {
  const std::map<std::string, Slugs> pages{{"FACTS.md", {"l1-memory", "sources"}}};
  int count = 0;
  const auto faults = [&](const std::string& text) {
    return joined(citation_faults("a.h", text, pages, count));
  };
  EXPECT_EQ(faults("// (FACTS.md#l1-memory, FACTS.md#sources)\n// FACTS.md"), "");
  EXPECT_EQ(count, 2);
  EXPECT_EQ(faults("\n// (FACTS.md#l1-memory; FACTS.md#l2)"), "a.h:2: no section FACTS.md#l2\n");
  EXPECT_EQ(faults("// FACTS.md#l1-\n// memory"), "a.h:1: no section FACTS.md#l1-\n");
  EXPECT_EQ(faults("source: \"SDK-1 (hw_facts 4.1)\""),
            "a.h:1: cites 'hw_facts', which is not in the project\n");
}

TEST(Citations, BrokenLinksAreFound) {
  const fs::path page = source_folder() / "README.md";
  const std::string text =
      "# One more: `page`!\n"
      "[a](LICENSE) [b](#one-more-page) [c](https://example.org/none) `[d](none)`\n"
      "```\n[e](none)\n# no heading\n```\n"
      "[f](none.md) and [g](#no-heading), [h](workload/PARAMETERS.md#none)\n";
  EXPECT_EQ(joined(link_faults("p.md", page, text)),
            "p.md:7: no file none.md\n"
            "p.md:7: no heading #no-heading\n"
            "p.md:7: no heading workload/PARAMETERS.md#none\n");
}

TEST(Citations, EqualHeadingsAreNumbered) {
  EXPECT_EQ(slugs_of("# A b\n## A b\n### A b\n#!/bin/sh\n"), (Slugs{"a-b", "a-b-1", "a-b-2"}));
}

}  // namespace
}  // namespace leviosim::tests
