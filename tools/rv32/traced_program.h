// The traced program as the trace sees it: its symbols, and the marks of its named functions
// (marked_functions.h), read from the ELF file.
#pragma once

#include <cxxabi.h>
#include <elf.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

namespace leviosim::rv32 {

/// What the code of a symbol is to the measurement.
enum class Role : std::uint8_t {
  Kernel,   ///< counted for the function that runs it
  Library,  ///< a routine with an account of its own (emulated arithmetic, popcount, memset)
  Host,     ///< book-keeping of the simulator, which the target does not do
};

struct Symbol {
  std::uint32_t begin, end;
  std::string name;      ///< as the linker knows it
  std::string function;  ///< unqualified name of the C++ function
  Role role = Role::Kernel;
  bool thumb = false;  ///< ARM's short instructions
};

struct Mark {
  bool entry;
  std::string name;    ///< of the named function
  std::string source;  ///< the C++ function in which the mark stands
};

class Program {
 public:
  explicit Program(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    image_.assign(std::istreambuf_iterator<char>(in), {});
    if (image_.size() < sizeof(Elf32_Ehdr)) throw std::runtime_error(path + " is no ELF file");
    read_symbols();
    read_marks();
  }

  /// The symbol that an address belongs to, or nullptr.
  const Symbol* symbol_at(std::uint32_t pc) const {
    const Symbol* symbol = last_symbol_before(pc);
    return symbol != nullptr && pc < symbol->end ? symbol : nullptr;
  }
  /// Whether ARM code there is of the short instructions. Symbols from assembly have no length.
  bool thumb_at(std::uint32_t pc) const {
    const Symbol* symbol = last_symbol_before(pc);
    return symbol != nullptr && symbol->thumb;
  }
  const Mark* mark_at(std::uint32_t pc) const {
    const auto it = marks_.find(pc);
    return it == marks_.end() ? nullptr : &it->second;
  }
  const std::map<std::uint32_t, Mark>& marks() const { return marks_; }

 private:
  const Symbol* last_symbol_before(std::uint32_t pc) const {
    auto it = std::upper_bound(symbols_.begin(), symbols_.end(), pc,
                               [](std::uint32_t a, const Symbol& s) { return a < s.begin; });
    return it == symbols_.begin() ? nullptr : &*std::prev(it);
  }
  template <class T>
  T at(std::size_t offset) const {
    T value;
    std::memcpy(&value, image_.data() + offset, sizeof value);
    return value;
  }
  Elf32_Shdr section(std::size_t i) const {
    const auto header = at<Elf32_Ehdr>(0);
    return at<Elf32_Shdr>(header.e_shoff + i * header.e_shentsize);
  }
  bool is_arm() const { return at<Elf32_Ehdr>(0).e_machine == EM_ARM; }
  std::size_t section_count() const { return at<Elf32_Ehdr>(0).e_shnum; }
  std::string text_in(const Elf32_Shdr& strings, std::uint32_t offset) const {
    return image_.data() + strings.sh_offset + offset;
  }
  /// A string of the loaded program.
  std::string text_at(std::uint32_t address) const {
    for (std::size_t i = 0; i < section_count(); ++i) {
      const Elf32_Shdr s = section(i);
      if (s.sh_type == SHT_PROGBITS && (s.sh_flags & SHF_ALLOC) && address >= s.sh_addr &&
          address < s.sh_addr + s.sh_size)
        return image_.data() + s.sh_offset + (address - s.sh_addr);
    }
    return {};
  }

  static std::string demangled(const std::string& name) {
    int status = 0;
    char* text = abi::__cxa_demangle(name.c_str(), nullptr, nullptr, &status);
    std::string result = status == 0 ? text : name;
    std::free(text);
    return result;
  }
  /// "leviosim::vio::f" of "int leviosim::vio::f<P>(int) const [clone .x]".
  static std::string qualified(const std::string& full) {
    std::string flat;
    int depth = 0;
    for (const char c : full) {
      if (c == '<') ++depth;
      if (depth == 0) flat += c;
      if (c == '>') --depth;
      if (c == '(' && depth == 0 && flat.size() > 1 && full.find("(anonymous") == std::string::npos)
        break;
    }
    flat = std::regex_replace(flat, std::regex("\\(anonymous namespace\\)::"), "");
    flat = flat.substr(0, flat.find('('));
    return flat.substr(flat.find_last_of(' ') + 1);
  }
  static Role role_of(const std::string& name, const std::string& full) {
    static const std::regex library(
        "__(add|sub|mul|div|neg)[sd]f3|__(eq|ne|lt|le|gt|ge|unord)[sd]f2|__extendsfdf2|"
        "__truncdfsf2|__float(un)?s[id][sd]f|__fix(uns)?[sd]fsi|__popcountsi2|__clzsi2|"
        "__aeabi_[^r].*|__(u?div|u?mod)si3|"
        "_?sinf|_?cosf|atan2f|memset|byte_memset|memcpy|memmove|.*digit_by_digit_sqrtf.*");
    static const std::regex host(
        "leviosim::work::Arena::(Arena|lend|place|host|alloc|reset_peak|~Arena)|"
        "leviosim::work::Machine::(begin_|end_|note_|flush_|Machine)|operator (new|delete)|"
        "std::vector|std::__|fmt::|leviosim::vio::ExtractorOptions::validate|"
        "leviosim::check_failed|__aeabi_read_tp|std::unique_ptr|leviosim::work::Job|leviosim::work:"
        ":StageRun");
    if (std::regex_match(name, library)) return Role::Library;
    if (std::regex_search(full, host) && full.find("fork<") == std::string::npos) return Role::Host;
    return Role::Kernel;
  }

  void read_symbols() {
    for (std::size_t i = 0; i < section_count(); ++i) {
      const Elf32_Shdr table = section(i);
      if (table.sh_type != SHT_SYMTAB) continue;
      const Elf32_Shdr strings = section(table.sh_link);
      for (std::size_t k = 0; k < table.sh_size / sizeof(Elf32_Sym); ++k) {
        const auto s = at<Elf32_Sym>(table.sh_offset + k * sizeof(Elf32_Sym));
        if (ELF32_ST_TYPE(s.st_info) != STT_FUNC) continue;
        const bool thumb = is_arm() && (s.st_value & 1u) != 0;
        const std::uint32_t begin = s.st_value - (thumb ? 1 : 0);
        Symbol symbol{
            begin, begin + std::max<std::uint32_t>(s.st_size, 2), text_in(strings, s.st_name), {}};
        symbol.thumb = thumb;
        const std::string full = demangled(symbol.name);
        const std::string name = qualified(full);
        symbol.function = name.substr(name.rfind(':') + 1);
        symbol.role = role_of(symbol.name, full);
        symbols_.push_back(symbol);
      }
    }
    forget_second_names();
    std::sort(symbols_.begin(), symbols_.end(),
              [](const Symbol& a, const Symbol& b) { return a.begin < b.begin; });
  }

  /// ARM's run-time library has names of its own for routines that have GCC's names, too.
  void forget_second_names() {
    const auto second = [](const Symbol& s) { return s.name.rfind("__aeabi_", 0) == 0; };
    std::set<std::uint32_t> named;
    for (const Symbol& s : symbols_)
      if (!second(s)) named.insert(s.begin);
    std::erase_if(symbols_, [&](const Symbol& s) { return second(s) && named.contains(s.begin); });
  }

  void read_marks() {
    const Elf32_Shdr names = section(at<Elf32_Ehdr>(0).e_shstrndx);
    for (std::size_t i = 0; i < section_count(); ++i) {
      const Elf32_Shdr s = section(i);
      if (text_in(names, s.sh_name) != ".leviosim_marks") continue;
      for (std::uint32_t k = 0; k + 12 <= s.sh_size; k += 12) {
        auto pc = at<std::uint32_t>(s.sh_offset + k);
        const auto name = at<std::uint32_t>(s.sh_offset + k + 4);
        const auto source = at<std::uint32_t>(s.sh_offset + k + 8);
        if (pc < 0x1000) continue;  // of code that the linker dropped
        if (is_arm()) pc &= ~1u;
        marks_[pc] = {name != 0, name != 0 ? text_at(name) : "",
                      source != 0 ? text_at(source) : ""};
      }
    }
  }

  std::vector<char> image_;
  std::vector<Symbol> symbols_;
  std::map<std::uint32_t, Mark> marks_;
};

}  // namespace leviosim::rv32
