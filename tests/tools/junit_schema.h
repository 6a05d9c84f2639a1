// Whether a text is JUnit as CI servers read it: the common part of the schemas of Jenkins and
// GitLab. Elements, their order of nesting, required attributes, and counts that agree.
#pragma once

#include <expat.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace leviosim::tools::testing {

class JUnitSchema {
 public:
  /// Empty if it is, else the first fault.
  static std::string fault(const std::string& text) {
    JUnitSchema schema;
    const std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser(
        XML_ParserCreate(nullptr), &XML_ParserFree);
    XML_SetUserData(parser.get(), &schema);
    XML_SetElementHandler(parser.get(), &JUnitSchema::begin, &JUnitSchema::end);
    if (XML_Parse(parser.get(), text.data(), static_cast<int>(text.size()), XML_TRUE) !=
        XML_STATUS_OK)
      return XML_ErrorString(XML_GetErrorCode(parser.get()));
    return schema.fault_;
  }

 private:
  using Attributes = std::map<std::string, std::string>;
  struct Element {
    std::string name;
    Attributes attributes;
    int tests = 0;
    int failures = 0;
  };

  void say(const std::string& fault) {
    if (fault_.empty()) fault_ = fault;
  }

  static void begin(void* self, const char* name, const char** pairs) {
    auto& schema = *static_cast<JUnitSchema*>(self);
    Attributes attributes;
    for (; *pairs != nullptr; pairs += 2) attributes[pairs[0]] = pairs[1];
    schema.open(name, std::move(attributes));
  }

  void open(const std::string& name, Attributes attributes) {
    struct Rule {
      std::string parent;
      std::vector<std::string> required;
    };
    static const std::map<std::string, Rule> rules{
        {"testsuites", {"", {"tests", "failures"}}},
        {"testsuite", {"testsuites", {"name", "tests", "failures", "errors", "time"}}},
        {"testcase", {"testsuite", {"classname", "name", "time"}}},
        {"system-out", {"testcase", {}}},
        {"failure", {"testcase", {"message", "type"}}}};
    const auto rule = rules.find(name);
    if (rule == rules.end()) return say("unknown element " + name), stack_.push_back({name, {}});
    if (rule->second.parent != (stack_.empty() ? "" : stack_.back().name))
      say(name + " at a wrong place");
    for (const std::string& key : rule->second.required)
      if (attributes.count(key) == 0) say(name + " without " + key);
    for (Element& element : stack_) {
      element.tests += name == "testcase" ? 1 : 0;
      element.failures += name == "failure" ? 1 : 0;
    }
    stack_.push_back({name, std::move(attributes)});
  }

  static void end(void* self, const char*) {
    auto& schema = *static_cast<JUnitSchema*>(self);
    const Element& element = schema.stack_.back();
    if (element.name == "testsuites" || element.name == "testsuite") {
      const auto count = [&](const char* key) {
        const auto it = element.attributes.find(key);
        return it == element.attributes.end() ? std::string() : it->second;
      };
      if (count("tests") != std::to_string(element.tests)) schema.say("wrong number of tests");
      if (count("failures") != std::to_string(element.failures))
        schema.say("wrong number of failures");
    }
    schema.stack_.pop_back();
  }

  std::string fault_;
  std::vector<Element> stack_;
};

inline std::string junit_fault(const std::string& text) { return JUnitSchema::fault(text); }

}  // namespace leviosim::tools::testing
